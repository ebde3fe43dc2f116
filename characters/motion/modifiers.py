"""Motions that change another one's time or place: each takes a motion and is one.

Those that keep a cycle in step (`Stretch`, `RootOffset`, and `Mirrored` of
`characters.motion.mirror`) are `Cyclic` as well, so a mirrored walk can be blended with a walk,
left foot to left foot.
"""

import itertools
import math
from bisect import bisect_right
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from characters.errors import CharacterError
from characters.motion.curves import check_knots
from characters.motion.motion import Motion, RootDelta
from characters.motion.phase import as_cyclic
from characters.skeleton import rotations
from characters.skeleton.pose import Pose


@dataclass(frozen=True)
class Stretch:
    """A motion that takes another time; `Cyclic`."""

    motion: Motion
    """What is played; it must have an end."""

    duration: float
    """How long it takes now [s]."""

    def __post_init__(self) -> None:
        """Refuse what has no length to stretch."""
        if not 0.0 < self.duration < math.inf:
            raise CharacterError(f"stretch to {self.duration} s; give a positive duration")
        _finite("stretch", self.motion)

    def sample(self, time: float) -> Pose:
        """Return the pose at a time [s]."""
        return self.motion.sample(time * self._rate)

    def travel(self, start: float, end: float) -> RootDelta:
        """Return how the root moves over the ground between two times [s]."""
        return self.motion.travel(start * self._rate, end * self._rate)

    def at(self, phase: float) -> Pose:
        """Return the pose at a phase."""
        return as_cyclic(self.motion).at(phase)

    def between(self, start: float, end: float) -> RootDelta:
        """Return how the root moves over the ground between two phases."""
        return as_cyclic(self.motion).between(start, end)

    @property
    def _rate(self) -> float:
        return self.motion.duration / self.duration


@dataclass(frozen=True)
class Window:
    """A part of a motion; before and after it, its first and last pose are held."""

    motion: Motion
    """What is played."""

    start: float
    """Where the part starts in the motion [s]."""

    end: float
    """Where it ends [s]; beyond the motion's end lies what that shows there."""

    def __post_init__(self) -> None:
        """Refuse a part that is none."""
        if not 0.0 <= self.start < self.end < math.inf:
            raise CharacterError(
                f"window: {self.start} s to {self.end} s; give a start of 0 or more and a later end"
            )

    @property
    def duration(self) -> float:
        """Length of the part [s]."""
        return self.end - self.start

    def sample(self, time: float) -> Pose:
        """Return the pose at a time [s]."""
        return self.motion.sample(self._time(time))

    def travel(self, start: float, end: float) -> RootDelta:
        """Return how the root moves over the ground between two times [s]."""
        return self.motion.travel(self._time(start), self._time(end))

    def _time(self, time: float) -> float:
        return min(max(self.start + time, self.start), self.end)


@dataclass(frozen=True)
class Loop:
    """A motion over and over, each time from where the last one led."""

    motion: Motion
    """What is repeated; it must have an end."""

    def __post_init__(self) -> None:
        """Refuse what never ends."""
        _finite("loop", self.motion)

    @property
    def duration(self) -> float:
        """Length of one round [s]."""
        return self.motion.duration

    def sample(self, time: float) -> Pose:
        """Return the pose at a time [s]."""
        return self.motion.sample(self._round(time)[1])

    def travel(self, start: float, end: float) -> RootDelta:
        """Return how the root moves over the ground between two times [s]."""
        (first, early), (last, late) = self._round(start), self._round(end)
        if first == last:
            return self.motion.travel(early, late)
        whole = self.motion.travel(0.0, self.duration)
        rest = self.motion.travel(early, self.duration)
        return rest.then(whole.repeated(last - first - 1)).then(self.motion.travel(0.0, late))

    def _round(self, time: float) -> tuple[int, float]:
        """Return which round a time [s] is in and the time in it."""
        if self.duration == 0.0:
            return 0, 0.0
        rounds = math.floor(time / self.duration)
        return rounds, min(max(time - rounds * self.duration, 0.0), self.duration)


@dataclass(frozen=True)
class RootOffset:
    """A motion that takes place elsewhere on the ground, all of it; `Cyclic`."""

    motion: Motion
    """What is played."""

    step: RootDelta
    """From its place to the new one."""

    roots: tuple[int, ...] = (0,)
    """Joints without a parent."""

    @property
    def duration(self) -> float:
        """Time until it repeats or ends [s]."""
        return self.motion.duration

    def sample(self, time: float) -> Pose:
        """Return the pose at a time [s]."""
        return self._placed(self.motion.sample(time))

    def travel(self, start: float, end: float) -> RootDelta:
        """Return how the root moves over the ground between two times [s]."""
        return self._seen(self.motion.travel(start, end))

    def at(self, phase: float) -> Pose:
        """Return the pose at a phase."""
        return self._placed(as_cyclic(self.motion).at(phase))

    def between(self, start: float, end: float) -> RootDelta:
        """Return how the root moves over the ground between two phases."""
        return self._seen(as_cyclic(self.motion).between(start, end))

    def _placed(self, pose: Pose) -> Pose:
        roots = list(self.roots)
        turn = rotations.about("y", self.step.yaw)
        moved, turned = pose.translations.copy(), pose.rotations.copy()
        ground = np.array([self.step.x, 0.0, self.step.z])
        moved[roots] = ground + rotations.rotate(turn, moved[roots])
        turned[roots] = rotations.multiply(turn, turned[roots])
        return replace(pose, translations=moved, rotations=turned)

    def _seen(self, step: RootDelta) -> RootDelta:
        """Return the step as seen from the origin, which the displaced root carries along."""
        return self.step.then(step).then(self.step.inverse())


@dataclass(frozen=True)
class TimeCurve:
    """Which time of a motion is shown when; smooth, and never beyond its knots between them.

    Monotone cubic interpolation (Fritsch and Butland, 1984). Before the first and after the last
    knot time stands still. It may stand still or run backwards between knots, too.
    """

    times: tuple[float, ...]
    """Times of what is shown [s], ascending."""

    sources: tuple[float, ...]
    """Times of the motion that they show [s], one for each."""

    def __post_init__(self) -> None:
        """Refuse times out of order."""
        check_knots("time curve", self.times, self.sources)

    def at(self, time: float) -> float:
        """Return the time of the motion [s] that is shown at a time [s].

        >>> TimeCurve((0.0, 1.0, 3.0), (0.0, 2.0, 6.0)).at(1.5)
        3.0
        """
        after = bisect_right(self.times, time)
        if after in (0, len(self.times)):
            return self.sources[max(after - 1, 0)]
        low, a, slope_a = self.times[after - 1], self.sources[after - 1], self._slopes[after - 1]
        gap, b, slope_b = self.times[after] - low, self.sources[after], self._slopes[after]
        u = (time - low) / gap
        slope_a, slope_b = slope_a * gap, slope_b * gap
        bend = 3 * (b - a) - 2 * slope_a - slope_b
        return a + u * (slope_a + u * (bend + u * (slope_a + slope_b - 2 * (b - a))))

    @cached_property
    def _slopes(self) -> list[float]:
        """Slope at each knot: the harmonic mean of its neighbours', 0 at a turning point."""
        knots = itertools.pairwise(zip(self.times, self.sources, strict=True))
        slopes = [(b - a) / (after - before) for (before, a), (after, b) in knots] or [0.0]
        inner = [2 * a * b / (a + b) if a * b > 0 else 0.0 for a, b in itertools.pairwise(slopes)]
        return [slopes[0], *inner, slopes[-1]]


@dataclass(frozen=True)
class Warped:
    """A motion whose time runs along a curve."""

    motion: Motion
    """What is played."""

    curve: TimeCurve
    """Which of its times is shown when."""

    @property
    def duration(self) -> float:
        """Time of the curve's last knot [s]."""
        return self.curve.times[-1]

    def sample(self, time: float) -> Pose:
        """Return the pose at a time [s]."""
        return self.motion.sample(self.curve.at(time))

    def travel(self, start: float, end: float) -> RootDelta:
        """Return how the root moves over the ground between two times [s]; backwards, too."""
        first, last = self.curve.at(start), self.curve.at(end)
        if last < first:
            return self.motion.travel(last, first).inverse()
        return self.motion.travel(first, last)


def _finite(what: str, motion: Motion) -> None:
    """Refuse a motion that never ends."""
    if not math.isfinite(motion.duration):
        raise CharacterError(
            f"{what}: a {type(motion).__name__} of duration {motion.duration} s has no end; "
            "take a Window of it"
        )
