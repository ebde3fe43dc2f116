"""Motions addressed by phase: 0 at the left footfall, one half at the right footfall."""

import itertools
import math
from abc import ABC, abstractmethod
from dataclasses import dataclass
from functools import cached_property
from typing import Protocol, cast

from cubeling.characters.motion.clip import Clip
from cubeling.characters.motion.contacts import find_contacts, spans
from cubeling.characters.motion.motion import Motion, RootDelta
from cubeling.characters.skeleton.feet import Feet, find_feet, foot_joints_by_side
from cubeling.characters.skeleton.pose import Pose, Skeleton
from cubeling.characters.smoothing import hermite

_MIN_STEP_CYCLES = 0.2  # feet that land within this part of a cycle land together
_MIN_LOOP_FRAMES = 5  # shorter loops contain no steps


class Cyclic(Motion, Protocol):
    """A motion that repeats, addressed by its phase: one cycle, two steps, per unit."""

    def at(self, phase: float) -> Pose:
        """Return the pose at a phase; whole numbers are left footfalls."""
        ...

    def between(self, start: float, end: float) -> RootDelta:
        """Return how the root moves over the ground between two phases, start ≤ end."""
        ...


def cycle_length(duration: float) -> float:
    """Return the length of a unit of phase [s]: a cycle, or one second if there is no cycle.

    >>> cycle_length(0.8), cycle_length(0.0), cycle_length(math.inf)
    (0.8, 1.0, 1.0)
    """
    return duration if 0.0 < duration < math.inf else 1.0


class PhaseDriven:
    """Base of `Cyclic` motions that are defined by phase; derives `sample` and `travel`."""

    def sample(self: Cyclic, time: float) -> Pose:
        """Return the pose at a time [s] since phase 0."""
        return self.at(time / cycle_length(self.duration))

    def travel(self: Cyclic, start: float, end: float) -> RootDelta:
        """Return how the root moves over the ground between two times [s]."""
        cycle = cycle_length(self.duration)
        return self.between(start / cycle, end / cycle)


@dataclass(frozen=True)
class PhasedMotion(PhaseDriven):
    """A looped motion with marks for its phase; `Cyclic`."""

    motion: Motion
    """What the phase runs through; the motion loops."""

    marks: tuple[float, ...] = ()
    """Times of phases 0, ½, 1, 1½ … over one loop of the motion [s]; empty: phase 0 at its start.

    Ascending, the first within the loop, all within one duration of the first; an even number.
    """

    @property
    def duration(self) -> float:
        """Length of one cycle [s]; a clip may contain several."""
        return self.motion.duration / max(len(self.marks) // 2, 1)

    def at(self, phase: float) -> Pose:
        """Return the pose at a phase."""
        return self.motion.sample(self.time(phase))

    def between(self, start: float, end: float) -> RootDelta:
        """Return how the root moves over the ground between two phases."""
        return self.motion.travel(self.time(start), self.time(end))

    def time(self, phase: float) -> float:
        """Return the time [s] in the motion at a phase, smoothly interpolated between the marks.

        Monotone cubic interpolation (Fritsch and Butland, 1984), which is linear for even steps.

        >>> import numpy as np
        >>> clip = Clip("c", 10.0, Pose(np.zeros((11, 1, 3)), np.zeros((11, 1, 4))))
        >>> PhasedMotion(clip, (0.2, 0.6)).time(0.5), PhasedMotion(clip, (0.2, 0.6)).time(-1.0)
        (0.6, -0.8)
        """
        if not self.marks:
            # Without marks phase 0 is the start of the loop.
            return phase * self.motion.duration
        loops, at = divmod(2 * phase, len(self.marks))
        mark = min(int(at), len(self.marks) - 1)
        time = hermite(*self._knots[mark], *self._knots[mark + 1], at - mark)
        return time + loops * self.motion.duration

    @cached_property
    def _knots(self) -> list[tuple[float, float]]:
        """Time [s] and slope [s per half cycle] at each mark and at the first of the next loop."""
        times = [*self.marks, self.marks[0] + self.motion.duration]
        gaps = [later - earlier for earlier, later in itertools.pairwise(times)]
        before = [gaps[-1], *gaps]
        after = [*gaps, gaps[0]]
        # The harmonic mean keeps time monotone: a walk never runs backward between two steps.
        slopes = [2 * a * b / (a + b) for a, b in zip(before, after, strict=True)]
        return list(zip(times, slopes, strict=True))


@dataclass(frozen=True)
class TransformedMotion(ABC):
    """Base of motions that change each pose and root delta of another motion; `Cyclic`."""

    motion: Motion

    @property
    def duration(self) -> float:
        """Time until it repeats or ends [s]."""
        return self.motion.duration

    @property
    def lead(self) -> float:
        """Phase of the motion ahead of the changed one."""
        return 0.0

    @abstractmethod
    def pose(self, pose: Pose) -> Pose:
        """Return a changed pose."""

    @abstractmethod
    def delta(self, delta: RootDelta) -> RootDelta:
        """Return a changed root delta."""

    def sample(self, time: float) -> Pose:
        """Return the pose at a time [s]."""
        return self.pose(self.motion.sample(time))

    def travel(self, start: float, end: float) -> RootDelta:
        """Return how the root moves over the ground between two times [s]."""
        return self.delta(self.motion.travel(start, end))

    def at(self, phase: float) -> Pose:
        """Return the pose at a phase."""
        return self.pose(as_cyclic(self.motion).at(phase + self.lead))

    def between(self, start: float, end: float) -> RootDelta:
        """Return how the root moves over the ground between two phases."""
        return self.delta(as_cyclic(self.motion).between(start + self.lead, end + self.lead))


@dataclass(frozen=True)
class StaticPose:
    """A pose that is held; `Cyclic`, with a cycle of any length."""

    pose: Pose

    duration: float
    """Length of its cycle [s], for blends."""

    def at(self, phase: float) -> Pose:
        """Return the pose, the same at every phase."""
        return self.pose

    def between(self, start: float, end: float) -> RootDelta:
        """Return no movement: a pose does not travel."""
        return RootDelta()

    sample = at
    travel = between


@dataclass(frozen=True)
class UnphasedMotion:
    """A motion without an end, as a `Cyclic` whose phase is its time in seconds."""

    motion: Motion

    @property
    def duration(self) -> float:
        """Infinite, as it has no cycle that a blend could match."""
        return math.inf

    def at(self, phase: float) -> Pose:
        """Return the pose at a time [s]."""
        return self.motion.sample(phase)

    def between(self, start: float, end: float) -> RootDelta:
        """Return how the root moves over the ground between two times [s]."""
        return self.motion.travel(start, end)

    sample = at
    travel = between


class RetimedMotion:
    """A cyclic motion that can be replaced while it plays, at the same phase; a `Motion`.

    Only the present motion is known: it is also returned for times before the last replacement.
    """

    def __init__(self, motion: Cyclic, phase: float = 0.0) -> None:
        self.restart(motion, phase)

    @property
    def duration(self) -> float:
        """Length of one cycle of the present motion [s]."""
        return self._motion.duration

    def phase(self, time: float) -> float:
        """Return the phase at a time [s]; it grows by one each cycle."""
        return self._phase + (time - self._time) / cycle_length(self._motion.duration)

    def change(self, motion: Cyclic, time: float) -> None:
        """Continue with another motion from a time [s] on, at the present phase."""
        # Whole cycles are dropped, so that a long session does not lose precision.
        self._phase, self._time = self.phase(time) % 1.0, time
        self._motion = motion

    def restart(self, motion: Cyclic, phase: float) -> None:
        """Start again with a motion at a phase, at time 0."""
        self._motion, self._time, self._phase = motion, 0.0, phase

    def sample(self, time: float) -> Pose:
        """Return the pose at a time [s]."""
        return self._motion.at(self.phase(time))

    def travel(self, start: float, end: float) -> RootDelta:
        """Return how the root moves over the ground between two times [s]."""
        return self._motion.between(self.phase(start), self.phase(end))


def as_cyclic(motion: Motion) -> Cyclic:
    """Return any motion as a cyclic one; without footfalls, phase 0 is its start."""
    # Called every frame; isinstance with a protocol would be ten times as slow.
    if hasattr(motion, "at") and hasattr(motion, "between"):
        return cast(Cyclic, motion)
    return PhasedMotion(motion) if math.isfinite(motion.duration) else UnphasedMotion(motion)


def has_footfalls(motion: Motion) -> bool:
    """Return whether phases 0 and ½ of a motion are a left and a right footfall."""
    if isinstance(motion, PhasedMotion):
        return bool(motion.marks)
    inner: Motion | None = getattr(motion, "motion", None)
    members: tuple[Motion, ...] = getattr(motion, "members", ())
    return any(map(has_footfalls, members if inner is None else (inner,)))


def with_phase(clip: Clip, skeleton: Skeleton) -> PhasedMotion:
    """Return a clip with its footfalls as marks, or without marks if it has no regular steps.

    On four legs the hind feet define the phase. Feet that land nearly together, as in a gallop or a
    hop, make one mark; the middle of the cycle is then the other mark.
    """
    feet = find_feet(skeleton)
    sides = foot_joints_by_side(skeleton)
    pair = [_hindmost(skeleton, [foot for foot in feet if set(foot) & set(side)]) for side in sides]
    left, right = footfalls(clip, skeleton, pair) if all(pair) else ([], [])
    if not left or len(left) != len(right):
        return PhasedMotion(clip)
    start = left[0]
    marks = [(t - start) % clip.duration + start for t in [*left, *right]]
    order = sorted(range(len(marks)), key=marks.__getitem__)
    if any((number < len(left)) != (place % 2 == 0) for place, number in enumerate(order)):
        return PhasedMotion(clip)  # two steps of one foot in sequence are not a walk
    marks.sort()
    gaps = [b - a for a, b in itertools.pairwise([*marks, marks[0] + clip.duration])]
    if min(gaps) < _MIN_STEP_CYCLES * clip.duration / len(left):
        lefts = [*marks[::2], marks[0] + clip.duration]
        halves = [(a + b) / 2 for a, b in itertools.pairwise(lefts)]
        marks = [time for both in zip(marks[::2], halves, strict=True) for time in both]
    return PhasedMotion(clip, tuple(marks))


def footfalls(clip: Clip, skeleton: Skeleton, feet: Feet) -> list[list[float]]:
    """Return the times [s] in a looped clip at which each foot lands, from its contacts."""
    if not clip.loop or len(clip) < _MIN_LOOP_FRAMES:
        return [[] for _ in feet]
    contacts = find_contacts(clip, skeleton, feet)
    landings = []
    for down in contacts.T:
        # A foot that never lifts never lands.
        found = [] if down.all() else spans(down, loop=True)
        landings.append([first / clip.rate for first, _ in found])
    return landings


def _hindmost(skeleton: Skeleton, feet: list[tuple[int, ...]]) -> tuple[int, ...]:
    """Return the foot that is farthest back at rest, or () if there are no feet."""
    places = skeleton.rest.globals(skeleton)[:, 2, 3]
    return min(feet, key=lambda foot: float(places[list(foot)].mean()), default=())
