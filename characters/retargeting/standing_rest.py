"""The rest pose of a recording whose zero pose does not stand.

Some motion capture files have all bones along one axis while every angle is zero. Retargeting
compares bodies that stand upright, so such a recording rests in one of its own frames.
"""

from dataclasses import replace
from itertools import pairwise

import numpy as np

from cubeling.characters.errors import CharacterError
from cubeling.characters.motion.clip import Clip
from cubeling.characters.skeleton import rotations
from cubeling.characters.skeleton.anatomy import SIDES, Anatomy
from cubeling.characters.skeleton.pose import Array, Pose, Skeleton

_MIN_UPRIGHT = 0.5  # cosine: bones farther than 60° from the vertical do not stand
_RAISED_FOOT_COST = 2.0  # of uprightness, for a foot that is raised by the body's height
_MAX_CANDIDATES = 300  # frames that are compared


def standing_skeleton(
    skeleton: Skeleton, anatomy: Anatomy, clip: Clip, rest: str | None
) -> Skeleton:
    """Return the skeleton of a recording at rest as its user states, or upright.

    Parameters
    ----------
    skeleton, anatomy
        The skeleton of the recording, with +y up, and its body parts.
    clip
        The recording.
    rest
        "zero" for the pose of the file, "frame:N" for a frame, counted from 0, and None for the
        pose of the file, or if it does not stand the frame in which the body is most upright.

    Raises
    ------
    CharacterError
        If there is no such frame.
    """
    if rest == "zero":
        return skeleton
    if rest is not None:
        return _rest_in(skeleton, anatomy, clip.poses[_stated_frame(rest, clip)])
    at_rest = skeleton.rest.globals(skeleton)[None]
    if uprightness(at_rest, anatomy)[0] >= _MIN_UPRIGHT:
        return skeleton
    frames = np.unique(np.linspace(0, len(clip) - 1, _MAX_CANDIDATES).round().astype(int))
    placements = clip.poses[frames].globals(skeleton)
    upright = uprightness(placements, anatomy)
    if upright.max() < _MIN_UPRIGHT:
        return skeleton
    standing = upright - _RAISED_FOOT_COST * _foot_lift(placements, anatomy)
    return _rest_in(skeleton, anatomy, clip.poses[int(frames[standing.argmax()])])


def uprightness(placements: Array, anatomy: Anatomy) -> Array:
    """Return how upright bodies stand, (frames,): the cosine of their least vertical bone.

    `placements` are of the joints, (frames, joints, 4, 4). Thighs, shins and the trunk count.
    """
    legs = [tuple(f"{side}{part}" for part in ("Foot", "LowerLeg", "UpperLeg")) for side in SIDES]
    chains = [*legs, ("hips", "chest"), ("hips", "neck"), ("hips", "head")]
    cosines = [np.ones(len(placements))]
    for chain in chains:
        for below, above in pairwise(chain):
            low, high = anatomy.joint(below), anatomy.joint(above)
            if low is None or high is None:
                continue
            bone = placements[:, high, :3, 3] - placements[:, low, :3, 3]
            length = np.linalg.norm(bone, axis=-1)
            cosines.append(bone[:, 1] / np.maximum(length, 1e-9))
    return np.asarray(np.min(cosines, axis=0), np.float64)


def _foot_lift(placements: Array, anatomy: Anatomy) -> Array:
    """Return how much higher one foot is than the other, (frames,), per height of the body."""
    ends = [anatomy.joint(f"{side}Toes") or anatomy.joint(f"{side}Foot") for side in SIDES]
    if None in ends:
        return np.zeros(len(placements))
    heights = placements[..., 1, 3]
    left, right = (heights[:, end] for end in ends)
    return np.asarray(np.abs(left - right) / np.maximum(np.ptp(heights, axis=1), 1e-9), np.float64)


def _stated_frame(rest: str, clip: Clip) -> int:
    kind, _, number = rest.partition(":")
    if kind != "frame" or not number.isdecimal():
        raise CharacterError(f"rest {rest!r} is not known; write zero, or frame:N as in frame:0")
    if int(number) >= len(clip):
        raise CharacterError(f"rest {rest!r}: the last frame is {len(clip) - 1}")
    return int(number)


def _rest_in(skeleton: Skeleton, anatomy: Anatomy, pose: Pose) -> Skeleton:
    """Return a skeleton that rests in a pose, turned ahead, above the origin."""
    bent = replace(skeleton, rest=pose)
    placements = pose.globals(skeleton)
    thighs = [anatomy.joint(f"{side}UpperLeg") for side in SIDES]
    turn = rotations.IDENTITY
    if None not in thighs:
        left, right = (placements[joint, :3, 3] for joint in thighs)
        across = left - right
        turn = rotations.about("y", np.arctan2(across[2], across[0]))
    roots = np.flatnonzero(np.array(skeleton.parents) < 0)
    translations, turns = bent.rest.translations.copy(), bent.rest.rotations.copy()
    hips = placements[anatomy.joints.get("hips", 0), :3, 3] * [1.0, 0.0, 1.0]
    translations[roots] = rotations.rotate(turn, translations[roots] - hips)
    turns[roots] = rotations.multiply(turn, turns[roots])
    return replace(bent, rest=replace(bent.rest, translations=translations, rotations=turns))
