"""When the phases of a gesture are, and how far it is at a time."""

import math
from dataclasses import dataclass

from cubeling.characters.behaviour.intents import StrokeTimes
from cubeling.characters.behaviour.symbolic_gesture import SymbolicGesture
from cubeling.characters.smoothing import interpolate

RETURN_SHARE = 0.4
"""Share of each stroke but the last that is the way back, if it does not end where it starts."""

MIN_PHASE_S = 1e-4
"""Phases that are shorter count as this long [s]."""

PREPARED, STROKE_END, GONE = 1.0, 2.0, 3.0
"""Phases, after 0.0, the start: the stroke lies between the first two; hands hold still there."""


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

    def period_share(self, time: float) -> float:
        """Return how much of its period is over at a time 0…1 of all of it.

        >>> Repeats(2, 1.0).period_share(0.75), Repeats(1, 1.0).period_share(1.0)
        (0.5, 1.0)
        """
        elapsed = time * self.periods
        return elapsed - min(math.floor(elapsed), self.count - 1)


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


def phase_at(times: StrokeTimes, now: float, apex: float, retraction: float) -> float:
    """Return how far a gesture is at a time: 0 before it … 3 after it, 1…2 in its stroke.

    `apex` is the share of the stroke at `times.stroke`; `retraction` is how long it takes [s] if
    its end is not known. A gesture whose `relax` is not known stays at the end of its stroke.
    """
    knots = [times.start, times.ready, times.stroke_start, times.stroke, times.stroke_end]
    phases = [0.0, PREPARED, PREPARED, PREPARED + apex, STROKE_END]
    if times.relax is not None:
        end = times.relax + retraction if times.end is None else times.end
        knots += [times.relax, end]
        phases += [STROKE_END, GONE]
    ascending: list[float] = []
    for knot in knots:  # a phase of no length, or out of order, gets the least length
        known = knot if knot == knot else ascending[-1]
        ascending.append(max(known, ascending[-1] + MIN_PHASE_S) if ascending else known)
    return interpolate(now, ascending, phases)
