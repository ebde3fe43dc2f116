"""Whole cycles of steps in recordings, as clips that loop.

A recording is searched for two moments between which each foot lands once and at which the body
looks and moves alike. Where a body is symmetric, one step and its mirror image are a whole cycle
too: so a run of half a second can go on for ever. The seam is inertialized.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from cubeling.characters.motion.inertialization import Inertialization, OffsetDecay
from cubeling.characters.motion.mirror import Mirror
from cubeling.characters.skeleton import rotations
from cubeling.characters.skeleton.pose import Array, Pose
from cubeling.characters.synthesis.library import Frames, MotionLibrary

CYCLE_S = (0.5, 1.7)
"""Shortest and longest cycle of two steps [s]."""

MIN_SPEED = 0.2
"""A slower body does not walk [body heights/s]."""

MAX_SEAM, MAX_MIRRORED_SEAM = 0.035, 0.08
"""How unlike the body may be at both ends of a cycle: mean distance of its joints, with a tenth of
a second of their velocities [body heights]; the second for a step and its mirror image."""

MAX_SPEED_CHANGE = 0.15
"""By how much the speed may differ between both ends, as a share of their mean."""

SPEED_CELL, TURN_CELL_RAD_S = 0.25, 0.6
"""Of the cycles whose mean speed [body heights/s] and yaw rate fall into one cell, the best is
taken."""

_VELOCITY_S = 0.1  # of the velocities in the difference of two moments
_SEAM_S = 0.3  # of the inertialization
_STRIDE = 2  # frames: pairs are compared at every other one


@dataclass(frozen=True)
class Cycle:
    """A part of a clip that can be repeated."""

    first: int
    """Its first frame in the library."""

    count: int
    """Number of frames until the body looks alike again."""

    mirrored: bool
    """Whether it is one step, and its mirror image follows."""

    seam: float
    """How unlike the body is at both ends; see `MAX_SEAM`."""

    speed: float
    """Mean speed [m/s]."""

    yaw_rate: float
    """Mean, to the left [rad/s]; 0 if mirrored."""


def with_cycles(library: MotionLibrary, mirror: Mirror | None = None) -> MotionLibrary:
    """Return a library with the cycles of its clips added, as clips that loop.

    One is added for each cell of speed and turn: that with the best seam. Cells in which a clip of
    the library loops itself need none.
    """
    best: dict[tuple[int, int], Cycle] = {}
    cells = _Cells(library)
    for cycle in find_cycles(library, mirror):
        cell = cells.of(cycle.speed, cycle.yaw_rate)
        if cell not in cells.taken and (cell not in best or cycle.seam < best[cell].seam):
            best[cell] = cycle
    chosen = sorted(best.values(), key=lambda cycle: cycle.first)
    return _append(library, [_looped(library, cycle, mirror) for cycle in chosen], chosen)


def find_cycles(library: MotionLibrary, mirror: Mirror | None = None) -> Iterator[Cycle]:
    """Yield, for each clip that does not loop and each length, the cycles with the best seams."""
    height = _height(library)
    for number, name in enumerate(library.names):
        frames = library.clip(name)
        if library.loops[number]:
            continue
        moments = _moments(library, frames, None)
        yield from _cycles(library, frames, moments, moments, False, height)
        if mirror is not None:
            other = _moments(library, frames, mirror)
            yield from _cycles(library, frames, moments, other, True, height)


class _Cells:
    """Cells of speed and yaw rate, and those in which a clip of a library loops."""

    def __init__(self, library: MotionLibrary) -> None:
        self._size = SPEED_CELL * _height(library)
        self.taken = set()
        for number in np.flatnonzero(library.loops).tolist():
            steps = library.steps[library.clip(library.names[number])]
            self.taken.add(self.of(*_rates(steps, library.rate)))

    def of(self, speed: float, yaw_rate: float) -> tuple[int, int]:
        """Return the cell of a speed [m/s] and a yaw rate [rad/s]."""
        return round(speed / self._size), round(yaw_rate / TURN_CELL_RAD_S)


def _height(library: MotionLibrary) -> float:
    return float(np.ptp(library.skeleton.rest.globals(library.skeleton)[:, 1, 3]))


def _rates(steps: Array, rate: float) -> tuple[float, float]:
    """Return the mean speed ahead [m/s] and yaw rate [rad/s] of steps (n, 3)."""
    return float(steps[:, 1].mean() * rate), float(steps[:, 2].mean() * rate)


def _moments(library: MotionLibrary, frames: Frames, mirror: Mirror | None) -> Array:
    """Return what two moments are compared by, (frames, columns): joints and their velocities."""
    positions, steps = library.positions[frames], library.steps[frames]
    if mirror is not None:
        positions = mirror.pose(library.poses[frames]).globals(library.skeleton)[..., :3, 3]
        steps = steps * [-1.0, 1.0, -1.0]
    velocities = np.gradient(positions, axis=0) * library.rate
    velocities = velocities + np.insert(steps[:, :2], 1, 0.0, axis=1)[:, None] * library.rate
    both = np.stack([positions, _VELOCITY_S * velocities], axis=1)
    rows: Array = both.reshape(len(frames), -1) / np.sqrt(positions.shape[1])
    return rows


def _cycles(
    library: MotionLibrary,
    frames: Frames,
    moments: Array,
    later: Array,
    mirrored: bool,
    height: float,
) -> Iterator[Cycle]:
    """Yield the best cycle of each length in a clip whose later end is compared by `later`."""
    landings = _landings(library, frames)
    speeds = library.steps[frames, 1] * library.rate
    way = np.vstack([np.zeros(3), np.cumsum(library.steps[frames], axis=0)])
    shortest, longest = (round(s * library.rate / (1 + mirrored)) for s in CYCLE_S)
    for count in range(shortest, min(longest, len(frames) - 2) + 1, _STRIDE):
        landed = landings[count:-1] - landings[: -count - 1]
        whole = landed.sum(1) == 1 if mirrored else (landed == 1).all(1)
        speed = (way[count:, 1] - way[:-count, 1])[: len(landed)] * library.rate / count
        change = np.abs(speeds[count:] - speeds[: len(landed)])
        steady = (speed > MIN_SPEED * height) & (change < MAX_SPEED_CHANGE * speed)
        starts = np.flatnonzero(whole & steady)
        if not len(starts):
            continue
        apart = np.linalg.norm(moments[starts] - later[starts + count], axis=1) / height
        best = int(apart.argmin())
        if apart[best] < (MAX_MIRRORED_SEAM if mirrored else MAX_SEAM):
            first = int(starts[best])
            turn = 0.0 if mirrored else float(way[first + count, 2] - way[first, 2])
            rate = turn * library.rate / count
            start = int(frames[first])
            yield Cycle(start, count, mirrored, float(apart[best]), float(speed[first]), rate)


def _landings(library: MotionLibrary, frames: Frames) -> NDArray[np.intp]:
    """Return how often each foot has landed before each frame, (frames + 1, feet)."""
    down = library.contacts[frames]
    lands = np.zeros((len(frames) + 1, down.shape[1]), np.intp)
    lands[2:] = np.cumsum(down[1:] & ~down[:-1], axis=0)
    return lands


@dataclass(frozen=True)
class _Loop:
    """The frames of a cycle that has been closed."""

    poses: Pose
    steps: Array
    contacts: NDArray[np.bool_]


def _looped(library: MotionLibrary, cycle: Cycle, mirror: Mirror | None) -> _Loop:
    """Return a cycle whose beginning goes on from its end, and passes over into itself."""
    frames = np.arange(cycle.first, cycle.first + cycle.count)
    poses, steps = library.poses[frames], library.steps[frames].copy()
    last = cycle.first + cycle.count
    following = int(library.onward(np.array([last]), 1)[0])
    ends = library.poses[np.array([last, following])]
    end_step = library.steps[last]
    if cycle.mirrored:
        assert mirror is not None
        ends, end_step = mirror.pose(ends), end_step * [-1.0, 1.0, -1.0]
    length = min(_SEAM_S, 0.8 * cycle.count / library.rate)
    old = ends[0], ends[1] if following != last else _onward(ends[0], poses)
    decay = Inertialization.begin(old, (poses[0], poses[1]), 1 / library.rate, length)
    shift = OffsetDecay(end_step - steps[0], np.zeros(3), length)
    times = np.arange(cycle.count) / library.rate
    closed = Pose.of_frames([decay.apply(poses[n], time) for n, time in enumerate(times.tolist())])
    steps += np.array([shift.at(time) for time in times.tolist()])
    contacts = library.contacts[frames]
    if cycle.mirrored:
        assert mirror is not None
        other = mirror.pose(closed)
        closed = Pose(
            np.concatenate([closed.translations, other.translations]),
            np.concatenate([closed.rotations, other.rotations]),
        )
        steps = np.concatenate([steps, steps * [-1.0, 1.0, -1.0]])
        contacts = np.concatenate([contacts, contacts[:, ::-1]])
    return _Loop(closed, steps, contacts)


def _onward(pose: Pose, poses: Pose) -> Pose:
    """Return a pose one frame later, where the clip ends: it moves as the cycle begins."""
    turned = rotations.multiply(poses.rotations[1], rotations.conjugate(poses.rotations[0]))
    return Pose(
        pose.translations + poses.translations[1] - poses.translations[0],
        rotations.multiply(turned, pose.rotations),
    )


def _append(
    library: MotionLibrary, loops: Sequence[_Loop], cycles: Sequence[Cycle]
) -> MotionLibrary:
    """Return a library with loops as further clips, named after what they were cut from."""
    if not loops:
        return library
    names = list(library.names)
    for cycle in cycles:
        name = f"{library.names[library.clip_of[cycle.first]]} cycle"
        same = sum(each.startswith(name) for each in names)
        names.append(name if not same else f"{name} {same + 1}")
    counts = [len(loop.steps) for loop in loops]
    poses = [library.poses, *(loop.poses for loop in loops)]
    return replace(
        library,
        names=tuple(names),
        starts=np.append(library.starts, library.starts[-1] + np.cumsum(counts)).astype(np.intp),
        loops=np.append(library.loops, np.ones(len(loops), bool)),
        poses=Pose(
            np.concatenate([each.translations for each in poses]),
            np.concatenate([each.rotations for each in poses]),
        ),
        steps=np.concatenate([library.steps, *(loop.steps for loop in loops)]),
        contacts=np.concatenate([library.contacts, *(loop.contacts for loop in loops)]),
    )
