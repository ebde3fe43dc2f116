"""Two-bone inverse kinematics of a leg over all frames; the foot keeps its orientation."""

from dataclasses import replace

import numpy as np

from cubeling.characters.retargeting.rig import LegJoints, Rig, global_rotations
from cubeling.characters.retargeting.transfer import ankle_positions, set_joint_positions
from cubeling.characters.skeleton import rotations
from cubeling.characters.skeleton.pose import Array, Pose

_MAX_REACH = 0.9995  # leg lengths; beyond, the knee would snap straight
_MIN_REACH = 0.35  # leg lengths, unless the clip bends the leg more
_MIN_BEND = 1e-3  # sine of the mean knee angle that shows the bending direction
_MAX_OVERSTRETCH = 0.26  # of a knee [rad]; one that bends by twice that bends as it does
_MEAN_BEND_WEIGHT = 0.15  # of the mean bending direction, in sines of the knee angle


def place_ankle(pose: Pose, rig: Rig, leg: LegJoints, target: Array) -> Pose:
    """Return poses (frames, joints, …) with an ankle at target positions (frames, 3) [m].

    The knee keeps its bending direction; its angle follows from the law of cosines. Positions are
    in the skeleton's own axes.
    """
    skeleton = rig.skeleton
    joints = skeleton.with_ancestors([leg.upper, leg.lower, leg.foot])
    placements = rig.placements(pose, joints)
    turns = np.zeros_like(pose.rotations)
    turns[:, joints] = global_rotations(placements[:, joints])
    hip, knee = placements[:, leg.upper, :3, 3], placements[:, leg.lower, :3, 3]
    bones = hip, knee, ankle_positions(placements, rig, leg)
    shin_turn, thigh_turn = _leg_turns(leg, rig, turns, bones, target)
    shin_and_thigh = rotations.multiply(thigh_turn, shin_turn)
    own = pose.rotations.copy()
    parents = skeleton.parents
    above = _global(turns, parents[leg.upper])
    own[:, leg.upper] = _relative(above, rotations.multiply(thigh_turn, turns[:, leg.upper]))
    above = rotations.multiply(thigh_turn, _global(turns, parents[leg.lower]))
    own[:, leg.lower] = _relative(above, rotations.multiply(shin_and_thigh, turns[:, leg.lower]))
    if leg.attached:
        above = rotations.multiply(shin_and_thigh, _global(turns, parents[leg.foot]))
        own[:, leg.foot] = _relative(above, turns[:, leg.foot])
    bent = replace(pose, translations=pose.translations.copy(), rotations=rotations.continuous(own))
    if not leg.attached:
        ankles = ankle_positions(rig.placements(bent, [leg.lower]), rig, leg)
        set_joint_positions(bent, rig, leg.foot, ankles)
    return bent


def _leg_turns(
    leg: LegJoints, rig: Rig, turns: Array, joints: tuple[Array, Array, Array], target: Array
) -> tuple[Array, Array]:
    """Return the turns of the shin about the knee and of the leg about the hip, (frames, 4)."""
    hip, knee, ankle = joints
    thigh, shin = hip - knee, ankle - knee
    thigh_length, shin_length = (np.linalg.norm(v, axis=-1) for v in (thigh, shin))
    total = thigh_length + shin_length
    reach = _keep_away(target - hip, ankle - hip, _MIN_REACH * total)
    distance = np.linalg.norm(reach, axis=-1)
    shortest = np.abs(thigh_length - shin_length) * 1.0005 + 1e-9
    distance = np.clip(distance, shortest, _MAX_REACH * total)
    up = thigh / thigh_length[:, None]
    side = _bending_direction(up, shin / shin_length[:, None], turns[:, leg.upper], rig)
    squares = thigh_length**2 + shin_length**2 - distance**2
    cosine = np.clip(squares / (2 * thigh_length * shin_length), -1.0, 1.0)[:, None]
    bent = shin_length[:, None] * (cosine * up + np.sqrt(1.0 - cosine**2) * side)
    return rotations.between(shin, bent), rotations.between(knee + bent - hip, reach)


def _keep_away(reach: Array, own: Array, min_distance: Array) -> Array:
    """Return target positions relative to the hip, (frames, 3), at a minimum distance or `own`'s.

    Close to the hip the direction of the leg is undefined, and the leg would spin: the closer a
    target is, the more it goes to the ankle of the clip.
    """
    min_distance = np.minimum(min_distance, np.linalg.norm(own, axis=-1))
    distance = np.linalg.norm(reach, axis=-1)
    share = np.clip(1.0 - distance / min_distance, 0.0, 1.0)
    reach = reach + share[:, None] * (own - reach)
    distance = np.maximum(np.linalg.norm(reach, axis=-1), 1e-9)
    return np.asarray(reach * np.maximum(min_distance / distance, 1.0)[:, None])


def _bending_direction(up: Array, shin: Array, turns: Array, rig: Rig) -> Array:
    """Return the side of the thigh to which the shin bends, (frames, 3).

    Where the leg is straight or overstretched, it is the mean side of all frames relative to the
    thigh; otherwise the knee would snap back and forth.
    """
    side = shin - np.einsum("ij,ij->i", shin, up)[:, None] * up
    mean = rotations.rotate(rotations.conjugate(turns), side).mean(0)
    size = float(np.linalg.norm(mean))
    if size > _MIN_BEND:
        known = rotations.rotate(turns, mean / size)
    else:  # a knee bends the shin backward
        skeleton_from_common = rotations.conjugate(rig.common_from_skeleton)
        known = np.broadcast_to(
            rotations.rotate(skeleton_from_common, [0.0, 0.0, -1.0]), side.shape
        )
    bend = np.linalg.norm(up + shin, axis=-1, keepdims=True)  # about its angle [rad]
    overstretched = np.clip(2.0 - bend / _MAX_OVERSTRETCH, 0.0, 1.0)
    along = np.einsum("ij,ij->i", side, known)[:, None]
    side = side + (overstretched * (np.abs(along) - along) + _MEAN_BEND_WEIGHT) * known
    side -= np.einsum("ij,ij->i", side, up)[:, None] * up
    return np.asarray(side / np.maximum(np.linalg.norm(side, axis=-1, keepdims=True), 1e-12))


def _global(turns: Array, joint: int) -> Array:
    """Return a joint's global rotation, (frames, 4); the identity above the roots."""
    return turns[:, joint] if joint >= 0 else np.broadcast_to(rotations.IDENTITY, (len(turns), 4))


def _relative(above: Array, turn: Array) -> Array:
    return rotations.multiply(rotations.conjugate(above), turn)
