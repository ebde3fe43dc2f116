"""Transfer of joint rotations and of the hips' trajectory from one rig to another.

Every joint rotates away from the common reference pose as its partner does, seen in the axes that
both rigs share. So the axes and the rest rotations of joints do not matter.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from cubeling.characters.motion.clip import Clip
from cubeling.characters.motion.contacts import find_contacts
from cubeling.characters.retargeting.mapping import JointMapping
from cubeling.characters.retargeting.relaxed_hands import relaxed_rest
from cubeling.characters.retargeting.rig import LegJoints, Rig, global_rotations
from cubeling.characters.retargeting.root import ground_positions
from cubeling.characters.skeleton import rotations
from cubeling.characters.skeleton.pose import Array, Pose

_FLAT_QUANTILE = 0.25  # of the heights of a standing ankle: later the heel rises
_MAX_SINKING = (
    0.03  # of a leg's length: ankles that come lower than that under rest do not stand so
)


def transferred_rotations(clip: Clip, source: Rig, target: Rig, mapping: JointMapping) -> Array:
    """Return the global rotations of the target, (frames, joints, 4), in the common axes."""
    placements = clip.poses.globals(source.skeleton)
    used, places = np.unique(mapping.sources, return_inverse=True)
    now = rotations.multiply(source.common_from_skeleton, global_rotations(placements[:, used]))
    from_rest = rotations.multiply(now, rotations.conjugate(source.rest_rotations[used]))
    first, second = (from_rest[:, column] for column in places.reshape(-1, 2).T)
    mapped = np.where(
        mapping.shares[:, None] > 0, rotations.slerp(first, second, mapping.shares), first
    )
    rest = relaxed_rest(target, source, mapping.joints, mapped)
    reference = rotations.multiply(mapping.corrections, rest[mapping.joints])
    mapped = rotations.multiply(mapped, reference)
    # Joints without a partner follow the nearest ancestor that has one.
    carrier = _nearest_mapped_ancestors(target, mapping.joints)
    result = np.tile(target.rest_rotations, (len(clip), 1, 1))
    carried = carrier >= 0
    ancestors = mapping.joints[carrier[carried]]
    relative = rotations.multiply(rotations.conjugate(rest[ancestors]), rest[carried])
    result[:, carried] = rotations.multiply(mapped[:, carrier[carried]], relative)
    return result


def _nearest_mapped_ancestors(rig: Rig, joints: NDArray[np.intp]) -> NDArray[np.intp]:
    """Return for each joint the index in `joints` of itself or its nearest ancestor, or −1."""
    index = {int(joint): number for number, joint in enumerate(joints)}
    nearest = np.full(len(rig.skeleton), -1)
    for joint, parent in enumerate(rig.skeleton.parents):
        nearest[joint] = index.get(joint, nearest[parent] if parent >= 0 else -1)
    return nearest


def hips_trajectory(clip: Clip, source: Rig, target: Rig) -> Array:
    """Return where the middle of the target's hips goes, (frames, 3) [m], in the common axes.

    It is between the thighs, wherever the joint is that carries them: in some models, on the
    ground.
    """
    ratio = target.leg_length / source.leg_length
    source_height = _ankle_height(source, clip)
    target_height = _standing_ankle_height(target)
    if target_height is None:
        target_height = ratio * source_height
    thighs = [leg.upper for leg in source.legs[:2]]
    positions = clip.poses.globals(source.skeleton)[:, thighs][..., :3, 3].mean(1)
    trajectory = rotations.rotate(source.common_from_skeleton, positions) * ratio
    own, others = _hips_height(target), _hips_height(source)
    trajectory[:, 1] += own + target_height - ratio * (others + source_height)
    return trajectory


def _hips_height(rig: Rig) -> float:
    """Return how high the middle of the hips is above the feet at rest [m]; 0 for people.

    The legs of people are aligned with each other, however they rest. Animals keep their stance,
    so its whole height counts.
    """
    if rig.anatomy.kind == "humanoid":
        return 0.0
    feet = [leg.foot for leg in rig.legs]
    return float(_middle_of_hips(rig)[1] - rig.rest_positions[feet, 1].mean())


def _middle_of_hips(rig: Rig) -> Array:
    """Return the middle between the thighs at rest, (3,) [m]."""
    return np.asarray(rig.rest_positions[[leg.upper for leg in rig.legs[:2]]].mean(0))


def _standing_ankle_height(rig: Rig) -> float | None:
    """Return the height of standing ankles [m], or None if a body does not rest on its feet."""
    heights = [rig.standing_ankle_height(leg) for leg in rig.legs]
    return float(np.mean(heights)) if rig.rests_on_feet else None


def _ankle_height(rig: Rig, clip: Clip) -> float:
    """Return the height of standing ankles in a clip [m].

    It is that at rest on the feet, else that of flat feet in the clip; so also in a recording whose
    feet come lower: its rest may be a stride, or its hips count from their place at rest.
    """
    at_rest = _standing_ankle_height(rig)
    feet = [leg.foot for leg in rig.legs]
    clip = clip_in_common_axes(clip, rig)
    heights = clip.poses.globals(rig.skeleton)[:, feet, 1, 3]
    lowest = float(np.median(heights.min(0)))
    if at_rest is not None and lowest > at_rest - _MAX_SINKING * rig.leg_length:
        return at_rest
    contacts = find_contacts(clip, rig.skeleton, [[foot] for foot in feet])
    if not contacts.any():
        return lowest
    return float(np.quantile(heights[contacts], _FLAT_QUANTILE))


def clip_in_common_axes(clip: Clip, rig: Rig) -> Clip:
    """Return a clip with its roots turned so that +y is up and +z ahead."""
    turn = rig.common_from_skeleton
    if np.allclose(turn, rotations.IDENTITY):
        return clip
    roots = np.flatnonzero(np.array(rig.skeleton.parents) < 0)
    poses = clip.poses
    translations, turns = poses.translations.copy(), poses.rotations.copy()
    translations[:, roots] = rotations.rotate(turn, translations[:, roots])
    turns[:, roots] = rotations.multiply(turn, turns[:, roots])
    return replace(clip, poses=replace(poses, translations=translations, rotations=turns))


def build_poses(rig: Rig, turns: Array, hips: Array, root: Array | None) -> Pose:
    """Return poses from global rotations and the path of the hips in the common axes.

    `turns` are (frames, joints, 4), `hips` (frames, 3) [m] the middle between the thighs, and the
    root trajectory (frames, 3) is x, z [m] and yaw [rad], or None without root motion.
    """
    skeleton, frames = rig.skeleton, len(turns)
    skeleton_from_common = rotations.conjugate(rig.common_from_skeleton)
    own = rotations.multiply(skeleton_from_common, turns)
    translations = np.tile(skeleton.rest.translations, (frames, 1, 1))
    scales = skeleton.rest.scales
    if scales is not None:
        scales = np.tile(scales, (frames, 1, 1))
    if root is not None:
        own[:, 0] = rotations.multiply(rotations.about("y", root[:, 2]), skeleton.rest.rotations[0])
        translations[:, 0] = ground_positions(root)
    pose = Pose(translations, local_rotations(own, skeleton.parents), scales)
    joint = rig.anatomy.joints["hips"]
    from_rest = rotations.multiply(turns[:, joint], rotations.conjugate(rig.rest_rotations[joint]))
    hips = hips + rotations.rotate(from_rest, rig.rest_positions[joint] - _middle_of_hips(rig))
    set_joint_positions(pose, rig, joint, rotations.rotate(skeleton_from_common, hips))
    for leg in rig.legs:
        if not leg.attached:
            ankles = ankle_positions(rig.placements(pose, [leg.lower]), rig, leg)
            set_joint_positions(pose, rig, leg.foot, ankles)
    return pose


def set_joint_positions(pose: Pose, rig: Rig, joint: int, positions: Array) -> None:
    """Move a joint of poses to positions (frames, 3) [m] in the skeleton's axes, in place."""
    parent = rig.skeleton.parents[joint]
    if parent >= 0:
        above: Array = rig.placements(pose, [parent])[:, parent]
        from_parent = (positions - above[:, :3, 3])[..., None]
        positions = np.asarray(np.linalg.solve(above[:, :3, :3], from_parent)[..., 0], float)
    pose.translations[:, joint] = positions


def ankle_positions(placements: Array, rig: Rig, leg: LegJoints) -> Array:
    """Return the positions of an ankle, (frames, 3) [m]: a fixed point of the shin."""
    rest = rig.skeleton.rest.globals(rig.skeleton)
    local = np.linalg.inv(rest[leg.lower]) @ rest[leg.foot, :, 3]
    positions: Array = placements[..., leg.lower, :3, :] @ local
    return positions


def in_common_axes(rig: Rig, positions: Array) -> Array:
    """Return positions (…, 3) of a skeleton's own axes in the common ones."""
    return rotations.rotate(rig.common_from_skeleton, positions)


def turns_from_rest(pose: Pose, rig: Rig, joints: Sequence[int]) -> Array:
    """Return how joints are turned from rest in the common axes, (frames, n, 4)."""
    turns = global_rotations(rig.placements(pose, joints)[:, joints])
    turns = rotations.multiply(rig.common_from_skeleton, turns)
    return rotations.multiply(turns, rotations.conjugate(rig.rest_rotations[joints]))


def with_turns_from_rest(pose: Pose, rig: Rig, joints: Sequence[int], turns: Array) -> Pose:
    """Return poses with joints, parents first, turned from rest by (frames, n, 4)."""
    skeleton_from_common = rotations.conjugate(rig.common_from_skeleton)
    own = pose.rotations.copy()
    turned = replace(pose, rotations=own)
    for number, joint in enumerate(joints):
        world = rotations.multiply(turns[:, number], rig.rest_rotations[joint])
        world = rotations.multiply(skeleton_from_common, world)
        parent = rig.skeleton.parents[joint]
        if parent >= 0:
            above = global_rotations(rig.placements(turned, [parent])[:, parent])
            world = rotations.multiply(rotations.conjugate(above), world)
        own[:, joint] = rotations.continuous(world)
    return turned


def local_rotations(turns: Array, parents: tuple[int, ...]) -> Array:
    """Return rotations relative to the parents, (frames, joints, 4), from global ones."""
    above = np.array(parents)
    relative = turns.copy()
    children = above >= 0
    relative[:, children] = rotations.multiply(
        rotations.conjugate(turns[:, above[children]]), turns[:, children]
    )
    return rotations.continuous(relative)
