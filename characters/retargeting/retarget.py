"""Retargeting a clip from one skeleton to another."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from cubeling.characters.errors import CharacterError
from cubeling.characters.model.mesh import Mesh
from cubeling.characters.motion.clip import Clip
from cubeling.characters.retargeting.feet.footskate import (
    ball_positions,
    find_foot_contacts,
    hold_feet_in_contact,
)
from cubeling.characters.retargeting.feet.ground_motion import find_ground_motion
from cubeling.characters.retargeting.mapping import map_joints
from cubeling.characters.retargeting.rig import Rig, leg_pairs
from cubeling.characters.retargeting.root import has_root_joint, root_trajectory
from cubeling.characters.retargeting.transfer import (
    build_poses,
    hips_trajectory,
    in_common_axes,
    transferred_rotations,
)
from cubeling.characters.skeleton import rotations
from cubeling.characters.skeleton.anatomy import Anatomy
from cubeling.characters.skeleton.pose import Array, Skeleton

# Of an animal's steps, in parts of the length of its legs.
_MAX_REACH = 0.99
_HIPS_DROP = 0.06
_MIN_STEP = 0.2


def retarget(
    clip: Clip,
    source: Skeleton,
    source_anatomy: Anatomy,
    target: Skeleton,
    target_anatomy: Anatomy,
    *,
    hold_feet: bool = True,
    meshes: Sequence[Mesh] = (),
) -> Clip:
    """Return a clip of one skeleton for another.

    Joints rotate as their partners do, whatever their axes, rest poses and names; distances are
    in proportion to the legs. A target with a root joint on the ground gets root motion. Joints
    without a partner stay at rest.

    Parameters
    ----------
    clip
        The motion.
    source, source_anatomy
        The skeleton of the clip, and which of its joints is which body part.
    target, target_anatomy
        The skeleton that is to move, and its body parts.
    hold_feet
        Whether the feet of the target stay in place on the ground while those of the source stand.
    meshes
        The skin of the target, whose soles then stay above the ground.

    Raises
    ------
    CharacterError
        If one is a person and the other a quadruped, or either lacks hips or legs.
    """
    try:
        rigs = Rig(source, source_anatomy), Rig(target, target_anatomy, meshes)
        return retarget_between(clip, *rigs, hold_feet=hold_feet)
    except CharacterError as error:
        raise CharacterError(f"clip {clip.name!r}: {error}") from None


def retarget_between(clip: Clip, source: Rig, target: Rig, *, hold_feet: bool = True) -> Clip:
    """Return a clip of one rig for another, as `retarget` does: rigs keep what they measured."""
    mapping = map_joints(source, target)
    ratio = target.leg_length / source.leg_length
    share = _stride_share(clip, source, target)
    hips = hips_trajectory(clip, source, target) * [share, 1.0, share]
    rooted = has_root_joint(target.skeleton, target.anatomy)
    root = root_trajectory(clip, source, ratio * share) if rooted else None
    pose = build_poses(target, transferred_rotations(clip, source, target, mapping), hips, root)
    if hold_feet:
        pairs = leg_pairs(source, target)
        source_legs, target_legs = [a for a, _ in pairs], [b for _, b in pairs]
        contacts = find_foot_contacts(clip, source, source_legs)
        ends = None
        if target.anatomy.kind == "quadruped":
            scale = ratio * np.array([share, 1.0, share])
            ends = _paw_positions(clip, source, target, contacts.ball, scale)
            at = in_common_axes(target, pose.globals(target.skeleton)[..., :3, 3])
            for number, leg in enumerate(target_legs):
                ends[:, number] += ball_positions(pose, target, leg) - at[:, leg.end]
        ground = find_ground_motion(clip, source, source_legs, contacts.ball, ratio * share)
        pose = hold_feet_in_contact(pose, target, target_legs, contacts, ground, ends)
    return Clip(clip.name, clip.rate, pose, clip.loop, rooted)


def _stride_share(clip: Clip, source: Rig, target: Rig) -> float:
    """Return how long steps may be in proportion to the legs, 0…1: straight legs step less far."""
    if target.anatomy.kind != "quadruped":
        return 1.0
    ratio = target.leg_length / source.leg_length
    placements = clip.poses.globals(source.skeleton)
    share = 1.0
    for theirs, own in leg_pairs(source, target):
        ends = placements[:, [theirs.upper, theirs.end]][..., :3, 3]
        at = rotations.rotate(source.common_from_skeleton, ends)
        rest = source.rest_positions[theirs.end] - source.rest_positions[theirs.upper]
        step = np.linalg.norm((at[:, 1] - at[:, 0] - rest)[:, [0, 2]], axis=-1).max() * ratio
        limb = target.rest_positions[own.upper] - target.rest_positions[own.foot]
        length = _MAX_REACH * sum(target.bone_lengths(own))
        reach = np.sqrt(max(length**2 - (limb[1] - _HIPS_DROP * length) ** 2, 0.0))
        reach -= np.hypot(limb[0], limb[2])
        share = min(share, max(reach, _MIN_STEP * length) / max(step, 1e-9))
    return float(share)


def _paw_positions(
    clip: Clip, source: Rig, target: Rig, contacts: NDArray[np.bool_], ratio: Array
) -> Array:
    """Return the positions of the ends of legs, (frames, legs, 3) [m].

    The legs of animals have different bones, so their angles do not determine the paws. These are
    as far from rest, and as high above where they stand, as in the source, in proportion.
    """
    placements = clip.poses.globals(source.skeleton)
    pairs = leg_pairs(source, target)
    theirs, own = [a.end for a, _ in pairs], [b.end for _, b in pairs]
    at = rotations.rotate(source.common_from_skeleton, placements[:, theirs][..., :3, 3])
    rest, others = target.rest_positions[own], source.rest_positions[theirs].copy()
    for number, (_, leg) in enumerate(pairs):
        down = contacts[:, number]
        if down.any():
            others[number, 1] = np.median(at[down, number, 1])
        rest[number, 1] += target.standing_ankle_height(leg) - target.rest_positions[leg.foot, 1]
    return np.asarray(rest + ratio * (at - others))
