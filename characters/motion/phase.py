"""Where in its stride a motion is: phase 0 at the left footfall, one half at the right.

Two clips that are both at phase 0.3 may be mixed: left steps then meet left steps, whatever the
lengths of the clips.
"""

import itertools
import math
from dataclasses import dataclass
from functools import cached_property
from typing import Protocol, cast

from characters.motion.clip import Clip
from characters.motion.contacts import Feet, feet_of, find_contacts, spans
from characters.motion.motion import Motion, RootDelta
from characters.skeleton.feet import find_feet
from characters.skeleton.pose import Pose, Skeleton

_TOGETHER = 0.2  # of a cycle: feet that land so soon after each other land together
_FEWEST = 5  # frames of a loop that can hold steps


class Cyclic(Motion, Protocol):
    """A motion that repeats, addressed by its phase: one cycle, two steps, per unit."""

    def at(self, phase: float) -> Pose:
        """Return the pose at a phase; whole numbers are left footfalls."""
        ...

    def between(self, start: float, end: float) -> RootDelta:
        """Return how the root moves over the ground between two phases, start ≤ end."""
        ...


def unit(duration: float) -> float:
    """Return what a unit of phase lasts [s]: a cycle, or a second where there is none.

    >>> unit(0.8), unit(0.0), unit(math.inf)
    (0.8, 1.0, 1.0)
    """
    return duration if 0.0 < duration < math.inf else 1.0


@dataclass(frozen=True)
class PhasedMotion:
    """A looped motion with marks for its phase; `Cyclic`."""

    motion: Motion
    """What is played."""

    marks: tuple[float, ...] = ()
    """Times of phases 0, ½, 1, 1½ … over one loop of the motion [s]; empty: phase 0 at its start.

    Ascending, the first within the loop, all within one duration of the first; an even number.
    """

    @property
    def duration(self) -> float:
        """Length of one cycle [s]; a clip may hold several."""
        return self.motion.duration / max(len(self.marks) // 2, 1)

    def at(self, phase: float) -> Pose:
        """Return the pose at a phase."""
        return self.motion.sample(self.time(phase))

    def between(self, start: float, end: float) -> RootDelta:
        """Return how the root moves over the ground between two phases."""
        return self.motion.travel(self.time(start), self.time(end))

    def sample(self, time: float) -> Pose:
        """Return the pose at a time [s] after a left footfall."""
        return self.at(time / unit(self.duration))

    def travel(self, start: float, end: float) -> RootDelta:
        """Return how the root moves over the ground between two times [s]."""
        cycle = unit(self.duration)
        return self.between(start / cycle, end / cycle)

    def time(self, phase: float) -> float:
        """Return the time [s] in the motion at a phase, through the marks and smooth at them.

        Monotone cubic interpolation (Fritsch and Butland, 1984): where steps are even it is a
        straight line.

        >>> import numpy as np
        >>> clip = Clip("c", 10.0, Pose(np.zeros((11, 1, 3)), np.zeros((11, 1, 4))))
        >>> PhasedMotion(clip, (0.2, 0.6)).time(0.5), PhasedMotion(clip, (0.2, 0.6)).time(-1.0)
        (0.6, -0.8)
        """
        if not self.marks:
            return phase * self.motion.duration
        loops, at = divmod(2 * phase, len(self.marks))
        mark = min(int(at), len(self.marks) - 1)
        u = at - mark
        (a, slope_a), (b, slope_b) = self._knots[mark], self._knots[mark + 1]
        between = a + u * (
            slope_a
            + u * (3 * (b - a) - 2 * slope_a - slope_b + u * (slope_a + slope_b - 2 * (b - a)))
        )
        return between + loops * self.motion.duration

    @cached_property
    def _knots(self) -> list[tuple[float, float]]:
        """Time [s] and slope [s per half cycle] at each mark and at the first of the next loop."""
        times = [*self.marks, self.marks[0] + self.motion.duration]
        gaps = [later - earlier for earlier, later in itertools.pairwise(times)]
        before = [gaps[-1], *gaps]
        after = [*gaps, gaps[0]]
        slopes = [2 * a * b / (a + b) for a, b in zip(before, after, strict=True)]
        return list(zip(times, slopes, strict=True))


@dataclass(frozen=True)
class StaticPose:
    """A pose that is held, as if it had a cycle; `Cyclic`."""

    pose: Pose
    """What is held."""

    duration: float
    """Length of the cycle that it keeps up with [s]."""

    def at(self, phase: float) -> Pose:
        """Return the pose."""
        return self.pose

    def between(self, start: float, end: float) -> RootDelta:
        """Return no motion."""
        return RootDelta()

    def sample(self, time: float) -> Pose:
        """Return the pose."""
        return self.pose

    def travel(self, start: float, end: float) -> RootDelta:
        """Return no motion."""
        return RootDelta()


@dataclass(frozen=True)
class UnphasedMotion:
    """A motion without an end, as if it had cycles of one second; `Cyclic`."""

    motion: Motion
    """What is played."""

    @property
    def duration(self) -> float:
        """It has no end."""
        return math.inf

    def at(self, phase: float) -> Pose:
        """Return the pose after so many seconds."""
        return self.motion.sample(phase)

    def between(self, start: float, end: float) -> RootDelta:
        """Return how the root moves over the ground between two times [s]."""
        return self.motion.travel(start, end)

    def sample(self, time: float) -> Pose:
        """Return the pose at a time [s]."""
        return self.motion.sample(time)

    def travel(self, start: float, end: float) -> RootDelta:
        """Return how the root moves over the ground between two times [s]."""
        return self.motion.travel(start, end)


def as_cyclic(motion: Motion) -> Cyclic:
    """Return any motion as one with a phase; where it has none of its own, 0 is its start."""
    # Asked for every frame, where an isinstance of a protocol would be ten times as slow.
    if hasattr(motion, "at") and hasattr(motion, "between"):
        return cast(Cyclic, motion)
    return PhasedMotion(motion) if math.isfinite(motion.duration) else UnphasedMotion(motion)


def takes_steps(motion: Motion) -> bool:
    """Return whether phase 0 of a motion is a left footfall and one half a right one."""
    if isinstance(motion, PhasedMotion):
        return bool(motion.marks)
    inner: Motion | None = getattr(motion, "motion", None)
    members: tuple[Motion, ...] = getattr(motion, "members", ())
    return any(map(takes_steps, members if inner is None else (inner,)))


def phased(clip: Clip, skeleton: Skeleton) -> PhasedMotion:
    """Return a clip with its footfalls as marks, or with none if it takes no regular steps.

    On four legs the hind pair tells the phase. Feet that land nearly together, as in a gallop or a
    hop, make one mark for both; the other half of the cycle is then marked in its middle.
    """
    feet = feet_of(skeleton)
    pair = [_hindmost(skeleton, [f for f in feet if set(f) & set(s)]) for s in find_feet(skeleton)]
    left, right = footfalls(clip, skeleton, pair) if all(pair) else ([], [])
    if not left or len(left) != len(right):
        return PhasedMotion(clip)
    start = left[0]
    marks = [(t - start) % clip.duration + start for t in [*left, *right]]
    order = sorted(range(len(marks)), key=marks.__getitem__)
    if any((number < len(left)) != (place % 2 == 0) for place, number in enumerate(order)):
        return PhasedMotion(clip)  # two steps of one foot in a row: no walk
    marks.sort()
    gaps = [b - a for a, b in itertools.pairwise([*marks, marks[0] + clip.duration])]
    if min(gaps) < _TOGETHER * clip.duration / len(left):
        lefts = [*marks[::2], marks[0] + clip.duration]
        halves = [(a + b) / 2 for a, b in itertools.pairwise(lefts)]
        marks = [time for both in zip(marks[::2], halves, strict=True) for time in both]
    return PhasedMotion(clip, tuple(marks))


def footfalls(clip: Clip, skeleton: Skeleton, feet: Feet) -> list[list[float]]:
    """Return the times [s] in a looped clip at which each foot lands, by contacts found in it."""
    if not clip.loop or len(clip) < _FEWEST:
        return [[] for _ in feet]
    contacts = find_contacts(clip, skeleton, feet)
    landings = []
    for down in contacts.T:
        # A foot that never lifts does not land.
        found = [] if down.all() else spans(down, loop=True)
        landings.append([first / clip.rate for first, _ in found])
    return landings


def _hindmost(skeleton: Skeleton, feet: list[tuple[int, ...]]) -> tuple[int, ...]:
    """Return the foot that is farthest back at rest; nothing if there is none."""
    places = skeleton.rest.globals(skeleton)[:, 2, 3]
    return min(feet, key=lambda foot: float(places[list(foot)].mean()), default=())
