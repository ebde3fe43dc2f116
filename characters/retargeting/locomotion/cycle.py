"""Finding in a recording one cycle of walking or running that closes best.

Where a person is in the same pose, and moves the same way, one step of each foot later, there the
recording is cut. What is left of a difference is spread over the whole cycle.
"""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from characters.errors import CharacterError
from characters.motion.clip import Clip
from characters.retargeting.body import Body
from characters.skeleton import rotations
from characters.skeleton.pose import Array, Pose

_PERIODS = (0.3, 2.4)  # [s] that a cycle may take
_AHEAD = 0.1  # [s]: how far ahead poses must agree, as much as now: their velocities
_MOST_STARTS = 400  # frames that are tried as the first


@dataclass(frozen=True)
class Cut:
    """A part of a clip that is one cycle."""

    start: int
    """First frame."""

    end: int
    """The frame that is like the first, one cycle later."""

    seam: float
    """How far joints are apart between both, root mean square [leg lengths]."""


def find_cycle(clip: Clip, body: Body, down: NDArray[np.bool_]) -> Cut:
    """Return the cycle that closes best, with one landing of each foot.

    Parameters
    ----------
    clip
        With root motion, on the body.
    body
        Whose joints are compared.
    down
        When the left and the right foot stand, (frames, 2).

    Raises
    ------
    CharacterError
        If in no part of the clip each foot lands just once.
    """
    features = _features(clip, body)
    landed = np.cumsum(down[1:] & ~down[:-1], axis=0)
    landed = np.concatenate([np.zeros((1, 2), int), landed])
    shortest, longest = (round(seconds * clip.rate) for seconds in _PERIODS)
    stride = max(1, (len(clip) - shortest) // _MOST_STARTS)
    best: Cut | None = None
    for start in range(0, len(clip) - shortest, stride):
        ends = np.arange(start + shortest, min(start + longest, len(clip) - 1) + 1)
        once = (landed[ends] - landed[start] == 1).all(-1)
        ends = ends[once]
        if not len(ends):
            continue
        apart = np.sqrt(np.square(features[ends] - features[start]).mean((-1, -2)))
        nearest = int(apart.argmin())
        if best is None or apart[nearest] < best.seam:
            best = Cut(start, int(ends[nearest]), float(apart[nearest]))
    if best is None:
        counts = " and ".join(str(int(number)) for number in landed[-1])
        raise CharacterError(
            f"clip {clip.name!r}: no whole cycle found; its left and right foot land {counts} "
            "times, and both must land once between two like poses; give a longer clip"
        )
    return best


def find_pause(clip: Clip, body: Body) -> Cut:
    """Return the part of a clip that closes best and is long enough to idle."""
    features = _features(clip, body)
    shortest = min(round(2.0 * clip.rate), (len(clip) - 1) // 2)
    longest = round(10.0 * clip.rate)
    stride = max(1, (len(clip) - shortest) // _MOST_STARTS)
    best = Cut(0, len(clip) - 1, float("inf"))
    for start in range(0, max(len(clip) - shortest, 1), stride):
        ends = np.arange(start + max(shortest, 1), min(start + longest, len(clip) - 1) + 1)
        if not len(ends):
            continue
        apart = np.sqrt(np.square(features[ends] - features[start]).mean((-1, -2)))
        # Of loops that close alike the longer one is the better.
        cost = apart / np.sqrt(ends - start)
        nearest = int(cost.argmin())
        if apart[nearest] / np.sqrt(ends[nearest] - start) < best.seam / np.sqrt(
            max(best.end - best.start, 1)
        ):
            best = Cut(start, int(ends[nearest]), float(apart[nearest]))
    return best


def closed(clip: Clip, cut: Cut) -> Clip:
    """Return a cycle as a loop in place, its seam spread evenly over it."""
    frames = slice(cut.start, cut.end + 1)
    poses = clip.in_place[frames]
    part = np.linspace(-0.5, 0.5, len(poses.rotations))[:, None, None]
    turns = rotations.align(poses.rotations, poses.rotations[0])
    first, last = turns[0], turns[-1]
    gap = rotations.to_rotation_vector(rotations.multiply(rotations.conjugate(last), first))
    turns = rotations.multiply(turns, rotations.from_rotation_vector(gap * part))
    shift = poses.translations[0] - poses.translations[-1]
    translations = poses.translations + shift * part
    morphs = poses.morphs
    if morphs is not None:
        morphs = morphs + (morphs[0] - morphs[-1]) * part[..., 0]
    scales = poses.scales
    if scales is not None:
        scales = scales + (scales[0] - scales[-1]) * part
    return replace(clip, poses=Pose(translations, turns, scales, morphs), loop=True)


def resampled(clip: Clip, rate: float) -> Clip:
    """Return a loop at another rate; its duration is rounded to whole frames."""
    frames = max(round(clip.duration * rate), 2)
    at = np.linspace(0.0, len(clip) - 1, frames + 1)
    before = np.minimum(at.astype(int), len(clip) - 2)
    part = (at - before)[:, None, None]
    poses = clip.poses
    turns = rotations.continuous(poses.rotations)

    def mixed(values: Array) -> Array:
        weight = part if values.ndim == 3 else part[..., 0]
        return np.asarray(values[before] * (1 - weight) + values[before + 1] * weight)

    fine = Pose(
        mixed(poses.translations),
        rotations.normalize(mixed(turns)),
        None if poses.scales is None else mixed(poses.scales),
        None if poses.morphs is None else mixed(poses.morphs),
    )
    return replace(clip, rate=rate, poses=fine)


def _features(clip: Clip, body: Body) -> Array:
    """Return what is compared of each frame: joints now and a little later, (frames, n, 3)."""
    joints = sorted(set(body.anatomy.joints.values()))
    placed = clip.in_place.globals(body.skeleton)[:, joints][..., :3, 3] / body.leg_length
    later = min(max(round(_AHEAD * clip.rate), 1), len(clip) - 1)
    # At the end of the clip the velocity is that of before.
    ahead = np.minimum(np.arange(len(clip)) + later, len(clip) - 1)
    velocity = placed[ahead] - placed[ahead - later]
    return np.concatenate([placed, velocity], axis=1)
