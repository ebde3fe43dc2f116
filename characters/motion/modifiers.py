"""Motions that change the time or place of another motion."""

import itertools
import math
from bisect import bisect_right
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from cubeling.characters.errors import CharacterError
from cubeling.characters.motion.curves import check_knots
from cubeling.characters.motion.motion import Motion, RootDelta
from cubeling.characters.motion.phase import TransformedMotion, as_cyclic
from cubeling.characters.skeleton import rotations
from cubeling.characters.skeleton.pose import Pose
from cubeling.characters.smoothing import hermite


@dataclass(frozen=True)
class Stretch:
    """A motion with another duration; `Cyclic`."""

    motion: Motion
    """The motion; it must have an end."""

    duration: float
    """The new duration [s]."""

    def __post_init__(self) -> None:
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
class TimeWindow:
    """A part of a motion; its first and last pose are held before and after it."""

    motion: Motion

    start: float
    """Start of the part in the motion [s]."""

    end: float
    """End of the part [s]; may be beyond the motion's end."""

    def __post_init__(self) -> None:
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
    """A motion that repeats; each repetition starts where the last one ended."""

    motion: Motion
    """The repeated motion; it must have an end."""

    def __post_init__(self) -> None:
        _finite("loop", self.motion)

    @property
    def duration(self) -> float:
        """Length of one repetition [s]."""
        return self.motion.duration

    def sample(self, time: float) -> Pose:
        """Return the pose at a time [s]."""
        return self.motion.sample(self._repetition(time)[1])

    def travel(self, start: float, end: float) -> RootDelta:
        """Return how the root moves over the ground between two times [s]."""
        (first, early), (last, late) = self._repetition(start), self._repetition(end)
        if first == last:
            return self.motion.travel(early, late)
        whole = self.motion.travel(0.0, self.duration)
        rest = self.motion.travel(early, self.duration)
        return rest.then(whole.repeat(last - first - 1)).then(self.motion.travel(0.0, late))

    def _repetition(self, time: float) -> tuple[int, float]:
        """Return the number of the repetition at a time [s] and the time in it [s]."""
        if self.duration == 0.0:
            return 0, 0.0
        rounds = math.floor(time / self.duration)
        # Rounding of the product may leave the interval by an ulp; the motion must not wrap there.
        return rounds, min(max(time - rounds * self.duration, 0.0), self.duration)


@dataclass(frozen=True)
class RootOffset(TransformedMotion):
    """A motion at another place on the ground; `Cyclic`."""

    offset: RootDelta
    """From its place to the new place."""

    roots: tuple[int, ...] = (0,)
    """The joints without a parent."""

    def pose(self, pose: Pose) -> Pose:
        """Return a pose at the new place."""
        roots = list(self.roots)
        turn = rotations.about("y", self.offset.yaw)
        moved, turned = pose.translations.copy(), pose.rotations.copy()
        ground = np.array([self.offset.x, 0.0, self.offset.z])
        moved[roots] = ground + rotations.rotate(turn, moved[roots])
        turned[roots] = rotations.multiply(turn, turned[roots])
        return replace(pose, translations=moved, rotations=turned)

    def delta(self, delta: RootDelta) -> RootDelta:
        """Return a delta of the motion in the frame of the new place."""
        # Conjugation: the same step, seen from the new place and heading.
        return self.offset.then(delta).then(self.offset.inverse())


PoseFilter = Callable[[Pose], Pose]
"""Changes a pose by itself, not where it is on the ground."""


@dataclass(frozen=True)
class Filtered(TransformedMotion):
    """A motion whose poses go through a filter; `Cyclic`."""

    filter: PoseFilter
    """Called with each sampled pose."""

    def pose(self, pose: Pose) -> Pose:
        """Return a filtered pose."""
        return self.filter(pose)

    def delta(self, delta: RootDelta) -> RootDelta:
        """Return the same delta."""
        return delta


@dataclass(frozen=True)
class TimeCurve:
    """Maps times to times of a motion, smoothly and without overshoot between the knots.

    Monotone cubic interpolation (Fritsch and Butland, 1984), constant before the first and after
    the last knot. Between knots time may also stand still or run backward.
    """

    times: tuple[float, ...]
    """Times of the result [s], ascending."""

    sources: tuple[float, ...]
    """Times of the motion [s], one for each time."""

    def __post_init__(self) -> None:
        check_knots("time curve", self.times, self.sources)

    def at(self, time: float) -> float:
        """Return the time of the motion [s] that is shown at a time [s].

        >>> TimeCurve((0.0, 1.0, 3.0), (0.0, 2.0, 6.0)).at(1.5)
        3.0
        """
        after = bisect_right(self.times, time)
        if after in (0, len(self.times)):
            return self.sources[max(after - 1, 0)]
        before = after - 1
        gap = self.times[after] - self.times[before]
        (a, slope_a), (b, slope_b) = (
            (self.sources[knot], self._slopes[knot] * gap) for knot in (before, after)
        )
        return hermite(a, slope_a, b, slope_b, (time - self.times[before]) / gap)

    @cached_property
    def _slopes(self) -> list[float]:
        """Slope at each knot: harmonic mean of the neighbouring slopes, 0 at an extremum."""
        knots = itertools.pairwise(zip(self.times, self.sources, strict=True))
        slopes = [(b - a) / (after - before) for (before, a), (after, b) in knots] or [0.0]
        inner = [2 * a * b / (a + b) if a * b > 0 else 0.0 for a, b in itertools.pairwise(slopes)]
        return [slopes[0], *inner, slopes[-1]]


@dataclass(frozen=True)
class Warped:
    """A motion whose time follows a curve."""

    motion: Motion

    curve: TimeCurve
    """Maps times to times of the motion."""

    @property
    def duration(self) -> float:
        """Time of the curve's last knot [s]."""
        return self.curve.times[-1]

    def sample(self, time: float) -> Pose:
        """Return the pose at a time [s]."""
        return self.motion.sample(self.curve.at(time))

    def travel(self, start: float, end: float) -> RootDelta:
        """Return how the root moves over the ground between two times [s], also backward."""
        first, last = self.curve.at(start), self.curve.at(end)
        if last < first:
            return self.motion.travel(last, first).inverse()
        return self.motion.travel(first, last)


def _finite(what: str, motion: Motion) -> None:
    if not math.isfinite(motion.duration):
        raise CharacterError(
            f"{what}: a {type(motion).__name__} of duration {motion.duration} s has no end; "
            "take a TimeWindow of it"
        )
