"""Finding the cycle of walking or running in a recording that closes best.

A recording is cut where pose and velocity repeat after one step of each foot. The remaining
difference is spread over the whole cycle.
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from cubeling.characters.errors import CharacterError
from cubeling.characters.motion.clip import Clip
from cubeling.characters.retargeting.rig import Rig
from cubeling.characters.skeleton import rotations
from cubeling.characters.skeleton.pose import Array, Pose

_CYCLE_DURATION_S = (0.3, 2.4)
_PAUSE_DURATION_S = (2.0, 10.0)
_VELOCITY_INTERVAL_S = 0.1
_MAX_STARTS = 400  # first frames that are tried


@dataclass(frozen=True)
class LoopCut:
    """A part of a clip that repeats."""

    start: int
    """Index of the first frame in the recording."""

    end: int
    """The frame that matches the first, one cycle later."""

    seam: float
    """Distance of the joints between both, root mean square [leg lengths]."""


def find_cycle(clip: Clip, rig: Rig, contacts: NDArray[np.bool_]) -> LoopCut:
    """Return the cycle that closes best for the way it goes, or refuse the clip.

    Each foot lands once in it; `contacts` say when the left and the right foot stand, (frames, 2).
    """
    landed = np.cumsum(contacts[1:] & ~contacts[:-1], axis=0)
    landings = np.concatenate([np.zeros((1, 2), int), landed])
    shortest, longest = (round(seconds * clip.rate) for seconds in _CYCLE_DURATION_S)
    best, best_cost = None, float("inf")
    for start, ends, seams in _seams(clip, rig, shortest, longest, landings):
        ways = np.linalg.norm(clip.track[ends, :2] - clip.track[start, :2], axis=1)
        turns = np.abs(clip.track[ends, 2] - clip.track[start, 2])
        # Shuffling in place and spinning close well, but are no gaits.
        costs = seams / np.maximum(ways * np.cos(np.minimum(turns / 2, np.pi / 2)), 1e-9)
        nearest = int(costs.argmin())
        if best is None or costs[nearest] < best_cost:
            best_cost = costs[nearest]
            best = LoopCut(start, int(ends[nearest]), float(seams[nearest]))
    if best is None:
        counts = " and ".join(str(int(number)) for number in landings[-1])
        raise CharacterError(
            f"clip {clip.name!r}: no whole cycle found; its left and right foot land {counts} "
            "times, and both must land once between two similar poses; give a longer clip"
        )
    return best


def find_pause(clip: Clip, rig: Rig) -> LoopCut:
    """Return the part of a clip that closes best and is long enough to idle."""
    shortest, longest = (round(seconds * clip.rate) for seconds in _PAUSE_DURATION_S)
    shortest = max(min(shortest, (len(clip) - 1) // 2), 1)
    best, best_cost = LoopCut(0, len(clip) - 1, float("inf")), float("inf")
    for start, ends, seams in _seams(clip, rig, shortest, longest):
        costs = seams / np.sqrt(ends - start)  # longer loops are better
        nearest = int(costs.argmin())
        if costs[nearest] < best_cost:
            best_cost = costs[nearest]
            best = LoopCut(start, int(ends[nearest]), float(seams[nearest]))
    return best


def close_loop(clip: Clip, cut: LoopCut) -> Clip:
    """Return a cycle as a loop in place, its seam spread evenly over it."""
    poses = clip.in_place[slice(cut.start, cut.end + 1)]
    part = np.linspace(-0.5, 0.5, len(poses.rotations))[:, None, None]
    turns = rotations.align(poses.rotations, poses.rotations[0])
    first, last = turns[0], turns[-1]
    gap = rotations.to_rotation_vector(rotations.multiply(rotations.conjugate(last), first))
    turns = rotations.multiply(turns, rotations.from_rotation_vector(gap * part))

    def close(values: Array) -> Array:
        weight = part if values.ndim == 3 else part[..., 0]
        return np.asarray(values + (values[0] - values[-1]) * weight)

    loop = Pose(
        close(poses.translations),
        turns,
        None if poses.scales is None else close(poses.scales),
        None if poses.morphs is None else close(poses.morphs),
    )
    return replace(clip, poses=loop, loop=True)


def resample_loop(clip: Clip, rate: float) -> Clip:
    """Return a loop at another rate; its duration is rounded to whole frames."""
    frames = max(round(clip.duration * rate), 2)
    at = np.linspace(0.0, len(clip) - 1, frames + 1)
    before = np.minimum(at.astype(int), len(clip) - 2)
    part = (at - before)[:, None, None]
    poses = clip.poses
    turns = rotations.continuous(poses.rotations)

    def interpolate(values: Array) -> Array:
        weight = part if values.ndim == 3 else part[..., 0]
        return np.asarray(values[before] * (1 - weight) + values[before + 1] * weight)

    resampled = Pose(
        interpolate(poses.translations),
        rotations.normalize(interpolate(turns)),
        None if poses.scales is None else interpolate(poses.scales),
        None if poses.morphs is None else interpolate(poses.morphs),
    )
    return replace(clip, rate=rate, poses=resampled)


def _features(clip: Clip, rig: Rig) -> Array:
    """Return the compared features of each frame: positions and velocities, (frames, n, 3)."""
    joints = sorted(set(rig.anatomy.joints.values()))
    positions = clip.in_place.globals(rig.skeleton)[:, joints][..., :3, 3] / rig.leg_length
    interval = min(max(round(_VELOCITY_INTERVAL_S * clip.rate), 1), len(clip) - 1)
    # At the end of the clip, the velocity is the last known one.
    later = np.minimum(np.arange(len(clip)) + interval, len(clip) - 1)
    velocities = positions[later] - positions[later - interval]
    return np.concatenate([positions, velocities], axis=1)


def _seams(
    clip: Clip, rig: Rig, shortest: int, longest: int, landings: NDArray[np.int_] | None = None
) -> Iterator[tuple[int, NDArray[np.intp], Array]]:
    """Yield first frames, the last frames that may go with each, and the seams between them.

    With the counted landings of the feet, (frames, 2), each foot lands once in between.
    """
    features = _features(clip, rig)
    stride = max(1, (len(clip) - shortest) // _MAX_STARTS)
    for start in range(0, len(clip) - shortest, stride):
        ends = np.arange(start + shortest, min(start + longest, len(clip) - 1) + 1)
        if landings is not None:
            ends = ends[(landings[ends] - landings[start] == 1).all(-1)]
        if len(ends):
            yield start, ends, np.sqrt(np.square(features[ends] - features[start]).mean((-1, -2)))
