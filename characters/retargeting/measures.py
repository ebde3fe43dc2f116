"""What retargeting should keep: knees, bone lengths, soles on the ground, the way ahead."""

from collections.abc import Sequence
from itertools import pairwise

import numpy as np

from cubeling.characters.model.character import skin
from cubeling.characters.model.mesh import Mesh
from cubeling.characters.retargeting.rig import LegJoints, Rig
from cubeling.characters.retargeting.soles import parts_of_joints
from cubeling.characters.retargeting.transfer import ankle_positions, in_common_axes
from cubeling.characters.skeleton import rotations
from cubeling.characters.skeleton.anatomy import SIDES
from cubeling.characters.skeleton.pose import Array, Pose

_KNEE_QUANTILES = (0.05, 0.25, 0.5, 0.75, 0.95)
_LIMBS = (("Arm", "Hand"), ("Leg", "Foot"))
_MAX_SKINNED_FRAMES = 24


def knee_bends(poses: Pose, rig: Rig, leg: LegJoints) -> Array:
    """Return how far a knee is bent, (frames,) [rad]; 0 is straight."""
    at = poses.globals(rig.skeleton)[:, [leg.upper, leg.lower, leg.foot]][..., :3, 3]
    thigh, shin = at[:, 1] - at[:, 0], at[:, 2] - at[:, 1]
    across = np.linalg.norm(np.cross(thigh, shin), axis=-1)
    return np.asarray(np.arctan2(across, (thigh * shin).sum(-1)), np.float64)


def knee_quantiles(poses: Pose, rig: Rig, leg: LegJoints) -> Array:
    """Return how far a knee is bent in the straightest to the most bent frames [rad], (5,)."""
    return np.asarray(np.quantile(knee_bends(poses, rig, leg), _KNEE_QUANTILES), np.float64)


def bone_change(poses: Pose, rig: Rig) -> float:
    """Return the greatest change of a limb bone's length in poses, as a share of it at rest."""
    joint = rig.anatomy.joint
    bones = []
    for side in ("left", "right"):
        for limb, end in _LIMBS:
            chain = [joint(f"{side}{part}") for part in (f"Upper{limb}", f"Lower{limb}", end)]
            bones += [(a, b) for a, b in pairwise(chain) if None not in (a, b)]
    if not bones:
        return 0.0
    starts, ends = np.array(bones).T
    lengths = [
        np.linalg.norm(at[..., ends, :] - at[..., starts, :], axis=-1)
        for pose in (rig.skeleton.rest, poses)
        for at in [pose.globals(rig.skeleton)[..., :3, 3]]
    ]
    at_rest = np.maximum(lengths[0], 1e-9)
    return float(np.abs(lengths[1] / at_rest - 1.0).max())


def foot_gap(poses: Pose, rig: Rig, legs: Sequence[LegJoints] | None = None) -> float:
    """Return how far a foot is from the end of its shin at most, as a share of the leg.

    `legs` are those that count; None for all.
    """
    gaps = [0.0]
    for leg in rig.legs if legs is None else legs:
        placements = rig.placements(poses, [leg.lower, leg.foot])
        apart = placements[:, leg.foot, :3, 3] - ankle_positions(placements, rig, leg)
        gaps.append(float(np.linalg.norm(apart, axis=-1).max()) / rig.leg_length)
    return max(gaps)


def hands_below_shoulders(poses: Pose, rig: Rig) -> float | None:
    """Return how much lower the higher hand is than its shoulder, in parts of the arm.

    The mean of poses (frames, …); an arm without a hand ends at its elbow. None without arms.
    """
    joint, heights = rig.anatomy.joint, []
    for side in SIDES:
        upper, ends = joint(f"{side}UpperArm"), [f"{side}Hand", f"{side}LowerArm"]
        end = next((found for part in ends if (found := joint(part)) is not None), None)
        if upper is None or end is None:
            continue
        placed = in_common_axes(rig, rig.placements(poses, [end])[..., :3, 3])
        arm = placed[:, upper] - placed[:, end]
        heights.append(float((arm[:, 1] / np.linalg.norm(arm, axis=-1)).mean()))
    return min(heights, default=None)


def trunk_tilt(poses: Pose, rig: Rig) -> Array:
    """Return the angle from hips to head against that at rest, (frames,) [rad]; 0 without them."""
    hips, head = (rig.anatomy.joint(part) for part in ("hips", "head"))
    if hips is None or head is None:
        return np.zeros(len(poses.rotations))
    placed = in_common_axes(rig, rig.placements(poses, [hips, head])[..., :3, 3])
    trunk = placed[:, head] - placed[:, hips]
    at_rest = rig.rest_positions[head] - rig.rest_positions[hips]
    # A body may lean at rest; to either side is as far as it is turned about the vertical.
    across = np.linalg.norm(trunk[:, [0, 2]], axis=-1)
    own = np.arctan2(np.linalg.norm(at_rest[[0, 2]]), at_rest[1])
    return np.asarray(np.abs(np.arctan2(across, trunk[:, 1]) - own), np.float64)


def facing_error(poses: Pose, rig: Rig) -> float:
    """Return the mean angle between the body's front and +z, −π…π [rad].

    The front is perpendicular to the line between the thighs.
    """
    leg_joints = {rig.anatomy.parts[leg.upper]: leg.upper for leg in rig.legs}
    left, right = (leg_joints.get(f"{side}UpperLeg") for side in ("left", "right"))
    if left is None or right is None:
        return 0.0
    at = poses.globals(rig.skeleton)[:, [left, right]][..., :3, 3]
    across = rotations.rotate(rig.common_from_skeleton, at[:, 0] - at[:, 1])
    across = across / np.maximum(np.linalg.norm(across, axis=-1, keepdims=True), 1e-9)
    x, _, z = across.mean(0)
    return float(np.arctan2(-z, x))


def sole_dip(
    poses: Pose, rig: Rig, meshes: Sequence[Mesh], most_frames: int = _MAX_SKINNED_FRAMES
) -> float:
    """Return how deep the skin of the feet goes below the soles at rest [m]; 0 without a skin.

    Poses are of a character that stands and walks on one plane.
    """
    own = sorted({joint for leg in rig.legs for joint in rig.foot_joints(leg)})
    soles = parts_of_joints(meshes, own)
    if not soles:
        return 0.0
    count = min(most_frames, len(poses.rotations))
    frames = np.linspace(0, len(poses.rotations) - 1, count).round().astype(int)
    up = rotations.rotate(rotations.conjugate(rig.common_from_skeleton), np.array([0.0, 1.0, 0.0]))
    lowest = [
        min(float((skin(sole, placements) @ up).min()) for sole in soles)
        for pose in (rig.skeleton.rest[None], poses[frames])
        for placements in pose.globals(rig.skeleton)
    ]
    return max(lowest[0] - min(lowest[1:]), 0.0)
