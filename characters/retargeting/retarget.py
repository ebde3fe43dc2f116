"""Retargeting: the whole line from one clip to another."""

import numpy as np

from characters.errors import CharacterError
from characters.motion.clip import Clip
from characters.retargeting.body import Body, Leg
from characters.retargeting.feet import find_footing, hold
from characters.retargeting.ground import way_of
from characters.retargeting.mapping import map_joints
from characters.retargeting.root import root_way
from characters.retargeting.transfer import ankle_heights, hips_way, posed, turned
from characters.skeleton import rotations
from characters.skeleton.anatomy import Anatomy
from characters.skeleton.pose import Array, Skeleton

_STRETCH, _LOWER = 0.99, 0.06  # parts of a leg's length: how far it reaches, and hips may come down


def retarget(
    clip: Clip,
    source: Skeleton,
    source_anatomy: Anatomy,
    target: Skeleton,
    target_anatomy: Anatomy,
    *,
    hold_feet: bool = True,
) -> Clip:
    """Return a clip of one skeleton as one of another.

    Joints turn as their partners do, whatever their axes, rest poses and names; ways are in
    proportion to the legs. A target with a root joint on the ground gets root motion, if the
    source goes anywhere. Joints without a partner stay as they rest.

    Parameters
    ----------
    clip, source, source_anatomy
        The motion, and what it is of.
    target, target_anatomy
        What is to move.
    hold_feet
        Whether feet that stand in the source are held in their places on the target, on its
        ground.

    Raises
    ------
    CharacterError
        If a person's motion is to go on a quadruped or the other way round, or either lacks hips
        or legs.
    """
    ours, theirs = Body(target, target_anatomy), Body(source, source_anatomy)
    try:
        return _retarget(clip, theirs, ours, hold_feet)
    except CharacterError as error:
        raise CharacterError(f"clip {clip.name!r}: {error}") from None


def _retarget(clip: Clip, source: Body, target: Body, hold_feet: bool) -> Clip:
    mapping = map_joints(source, target)
    ratio = target.leg_length / source.leg_length
    share = stride_share(clip, source, target)
    heights = ankle_heights(clip, source, target)
    hips = hips_way(clip, source, target, heights) * [share, 1.0, share]
    hips_joint = target.anatomy.joints["hips"]
    rooted = target.skeleton.has_root_motion and hips_joint != 0
    root = root_way(clip, source, ratio * share) if rooted else None
    pose = posed(target, turned(clip, source, target, mapping), hips, root)
    if hold_feet:
        pairs = leg_pairs(source, target)
        theirs, ours = [a for a, _ in pairs], [b for _, b in pairs]
        ends = None
        if target.anatomy.kind == "quadruped":
            ends = _paw_ways(clip, source, target, ratio * np.array([share, 1.0, share]))
        footing = find_footing(clip, source, theirs)
        way = way_of(clip, source, theirs, footing.ball, ratio * share)
        pose = hold(pose, target, ours, footing, way, ends)
    return Clip(clip.name, clip.rate, pose, clip.loop, rooted)


def leg_pairs(source: Body, target: Body) -> list[tuple[Leg, Leg]]:
    """Return the legs that both bodies have."""
    by_part = {source.anatomy.parts[leg.foot]: leg for leg in source.legs}
    return [
        (by_part[part], leg)
        for leg in target.legs
        if (part := target.anatomy.parts[leg.foot]) in by_part
    ]


def stride_share(clip: Clip, source: Body, target: Body) -> float:
    """Return how long steps may be, as a part of what is in proportion to the legs, 0…1.

    A beast that stands on straight legs cannot step as far as one on bent legs.
    """
    if target.anatomy.kind != "quadruped":
        return 1.0
    ratio = target.leg_length / source.leg_length
    globals_ = clip.poses.globals(source.skeleton)
    share = 1.0
    for theirs, ours in leg_pairs(source, target):
        at = rotations.rotate(source.upright, globals_[:, [theirs.upper, theirs.end]][..., :3, 3])
        rest = source.rest_places[theirs.end] - source.rest_places[theirs.upper]
        away = np.linalg.norm((at[:, 1] - at[:, 0] - rest)[:, [0, 2]], axis=-1).max() * ratio
        limb = target.rest_places[ours.upper] - target.rest_places[ours.foot]
        length = _STRETCH * sum(target.bones(ours))
        reach = np.sqrt(max(length**2 - (limb[1] - _LOWER * length) ** 2, 0.0))
        reach -= np.hypot(limb[0], limb[2])
        share = min(share, max(reach, 0.2 * length) / max(away, 1e-9))
    return float(share)


def _paw_ways(clip: Clip, source: Body, target: Body, ratio: Array) -> Array:
    """Return where the paws go, (frames, legs, 3) [m]: away from where they rest, in proportion.

    Beasts' legs have their bones in other places, so angles say little about where paws are.
    """
    globals_ = clip.poses.globals(source.skeleton)
    pairs = leg_pairs(source, target)
    theirs, ours = [a.end for a, _ in pairs], [b.end for _, b in pairs]
    at = rotations.rotate(source.upright, globals_[:, theirs][..., :3, 3])
    return target.rest_places[ours] + ratio * (at - source.rest_places[theirs])
