"""When the phases of a gesture are, and how far it is at a time."""

from collections.abc import Iterable
from copy import copy
from dataclasses import dataclass
from typing import Self

from cubeling.characters.behaviour.intents import StrokeTimes
from cubeling.characters.behaviour.symbolic_gesture import SymbolicGesture
from cubeling.characters.smoothing import interpolate

RETURN_SHARE = 0.4
"""Share of each stroke but the last that is the way back, if it does not end where it starts."""

MIN_PHASE_S = 1e-4
"""Phases that are shorter count as this long [s]."""

ASSUMED_HOLD_S = 1.0
"""A hold whose end is not known is planned to last so long [s]; hands wait in its middle."""


@dataclass(frozen=True)
class Repeats:
    """A stroke that is performed several times; times are 0…1 of all of it."""

    count: int
    """How many times it is performed, at least 1."""

    share: float
    """Share of one period that the stroke takes; the rest is the way back."""

    @staticmethod
    def of(gesture: SymbolicGesture) -> "Repeats":
        """Return those of a gesture."""
        closed = all(
            len(keys) < 2 or keys[0].place == keys[-1].place
            for keys in (gesture.right, gesture.left)
        )
        returns = gesture.repeats > 1 and not closed
        return Repeats(gesture.repeats, 1.0 - RETURN_SHARE if returns else 1.0)

    @property
    def periods(self) -> float:
        """Length of all of it in periods: the last one has no way back."""
        return self.count - 1.0 + self.share

    @property
    def returns(self) -> bool:
        """Whether there is a way back."""
        return self.share < 1.0

    def in_all(self, period: int, time: float) -> float:
        """Return the time 0…1 of all of it at a time 0…1 of one period.

        >>> Repeats(2, 1.0).in_all(1, 0.5), Repeats(2, 0.6).in_all(1, 0.6)
        (0.75, 1.0)
        """
        return (period + time) / self.periods


def apex_share(gesture: SymbolicGesture) -> float:
    """Return when the apex of the first stroke is, 0…1 of all strokes."""
    repeats = Repeats.of(gesture)
    return gesture.apex * repeats.share / repeats.periods


def stroke_length(gesture: SymbolicGesture) -> float:
    """Return how long all strokes take, as the gesture is written [s]."""
    repeats = Repeats.of(gesture)
    return gesture.stroke * repeats.periods / repeats.share


def natural_times(gesture: SymbolicGesture, start: float = 0.0) -> StrokeTimes:
    """Return the times of a gesture as it is written, from a start [s].

    >>> from cubeling.characters.behaviour.symbolic_gesture import HandKey
    >>> times = natural_times(SymbolicGesture("NOW", right=(HandKey(1.0),)), 1.0)
    >>> times.ready, round(times.stroke_end, 6), round(times.end, 6)
    (1.5, 2.1, 2.9)
    """
    ready = start + gesture.preparation
    length = stroke_length(gesture)
    relax = ready + length + gesture.hold
    return StrokeTimes(
        start,
        ready,
        relax,
        relax + gesture.retraction,
        stroke_start=ready,
        stroke=ready + apex_share(gesture) * length,
        stroke_end=ready + length,
    )


class PhaseTimes:
    """The times of a gesture with all phases in order, each of at least the least length.

    Times that are not known are planned: `apex` is the share of all strokes at `times.stroke`,
    `retraction` how long it takes [s].
    """

    def __init__(self, times: StrokeTimes, apex: float, retraction: float) -> None:
        self._apex = apex
        self.held = times.relax is None
        """Whether it stays at the end of its stroke until more is known."""
        relax, end = times.relax, times.end
        if relax is None:
            relax = times.stroke_end + ASSUMED_HOLD_S
            end = None
        asked = (times.start, times.ready, times.stroke_start, times.stroke, times.stroke_end)
        self._take(_in_order((*asked, relax, relax + retraction if end is None else end)))

    def _take(self, knots: list[float]) -> None:
        self.knots = knots
        """Start, ready, stroke start, stroke, stroke end, relax and end [s], ascending."""
        self.start, self.ready, self.stroke_start, self.stroke = knots[:4]
        self.stroke_end, self.relax, self.end = knots[4:]

    def later(self, seconds: float) -> Self:
        """Return the times with all but the start later by so much [s]."""
        other = copy(self)
        other._take([self.knots[0], *(knot + seconds for knot in self.knots[1:])])
        return other

    def in_stroke(self, share: float) -> float:
        """Return when a share of all strokes is over [s]: the apex falls on `stroke`."""
        if self._apex >= 1.0:
            return interpolate(share, (0.0, 1.0), (self.stroke_start, self.stroke))
        if self._apex <= 0.0:
            return interpolate(share, (0.0, 1.0), (self.stroke, self.stroke_end))
        knots = (self.stroke_start, self.stroke, self.stroke_end)
        return interpolate(share, (0.0, self._apex, 1.0), knots)

    def at(self, now: float, own: "PhaseTimes") -> float:
        """Return the time of `own`, the times that it was planned for, at which it is as far.

        >>> from dataclasses import replace
        >>> times = natural_times(SymbolicGesture("NOW", preparation=0.5, stroke=1.0))
        >>> planned = PhaseTimes(times, 1.0, 0.6)
        >>> PhaseTimes(replace(times, ready=1.0, stroke_start=1.0), 1.0, 0.6).at(0.5, planned)
        0.25
        """
        if self.held:
            now = min(now, 0.5 * (self.stroke_end + self.relax))
        return interpolate(now, self.knots, own.knots)


def _in_order(times: Iterable[float]) -> list[float]:
    """Return times in order: what is not known, has no length or is too early gets the least."""
    ascending: list[float] = []
    for time in times:
        known = time if time == time else ascending[-1]
        ascending.append(max(known, ascending[-1] + MIN_PHASE_S) if ascending else known)
    return ascending
