"""Intents that begin, go on and end: what a scenario wants now becomes intents with times."""

from dataclasses import replace
from functools import cache
from typing import Any, Generic, TypeVar

from cubeling.characters.behaviour import (
    GazeIntent,
    GestureCollection,
    GestureIntent,
    HeadIntent,
    ReachIntent,
    StrokeTimes,
    SymbolicGesture,
    Times,
)

Intent = TypeVar("Intent", ReachIntent, GestureIntent, HeadIntent, GazeIntent)

LEAVE_S = 0.5
"""Time in which something ends that is no longer wanted [s]."""


class Ongoing(Generic[Intent]):
    """Intents of one kind, of which the scenario wants at most one at a time.

    One that is wanted again, by its key, keeps its times and takes its other fields from now: its
    target may move. One that is no longer wanted ends within `LEAVE_S`, while the next one begins.
    """

    def __init__(self) -> None:
        self._key, self._begun = "", 0
        self._current: Intent | None = None
        self._leaving: list[Intent] = []

    def update(self, now: float, wanted: Intent | None) -> tuple[Intent, ...]:
        """Return the intents of a frame, the present one last.

        `wanted` has the times that it has if it begins in this frame [s].
        """
        current, key = self._current, "" if wanted is None else wanted.key
        if key != self._key:
            if current is not None:
                self._leaving.append(_with(current, times=leave(current.times, now)))
            self._key, self._begun = key, self._begun + 1
            self._current = wanted and _with(wanted, key=f"{key} {self._begun}")
        elif wanted is not None and current is not None:
            self._current = _with(wanted, key=current.key, times=current.times)
        self._leaving = [each for each in self._leaving if _lasts(each.times, now)]
        live = [] if self._current is None else [self._current]
        return tuple(each for each in self._leaving + live if _lasts(each.times, now))


def _with(intent: Intent, **changes: Any) -> Intent:
    return replace(intent, **changes)


def _lasts(times: Times, now: float) -> bool:
    return times.end is None or now < times.end


def leave(times: Times, now: float) -> Times:
    """Return times that end within `LEAVE_S` from now on [s].

    >>> leave(Times(0.0, 1.0), 2.0)
    Times(start=0.0, ready=1.0, relax=2.0, end=2.5)
    """
    relax = now if times.relax is None else min(times.relax, now)
    end = now + LEAVE_S if times.end is None else min(times.end, now + LEAVE_S)
    ready = min(times.ready, relax)
    if not isinstance(times, StrokeTimes):
        return replace(times, ready=ready, relax=relax, end=end)
    strokes = {name: min(getattr(times, name), relax) for name in _STROKE}
    return replace(times, ready=ready, relax=relax, end=end, **strokes)


_STROKE = ("stroke_start", "stroke", "stroke_end")  # of `StrokeTimes`


@cache
def bundled_gesture(name: str) -> SymbolicGesture:
    """Return a bundled gesture by its name."""
    return GestureCollection.load_bundled().get(name)


def gesture_times(gesture: SymbolicGesture, start: float, hold: float | None = None) -> StrokeTimes:
    """Return when the phases of a gesture are that begins at a time [s].

    It is held for `hold` [s] after its stroke, as it is written if that is None; an infinite hold
    lasts until it is no longer wanted.
    """
    ready = start + gesture.preparation
    stroke_end = ready + gesture.stroke * gesture.repeats
    relax = stroke_end + (gesture.hold if hold is None else hold)
    return StrokeTimes(
        start,
        ready,
        None if relax == float("inf") else relax,
        None if relax == float("inf") else relax + gesture.retraction,
        stroke_start=ready,
        stroke=ready + gesture.apex * gesture.stroke,
        stroke_end=stroke_end,
    )
