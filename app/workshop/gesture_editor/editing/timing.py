"""Where the phases and the keys of a gesture are in time."""

from cubeling.app.workshop.gesture_editor.editing.edits import Phase
from cubeling.characters.behaviour import Repeats, SymbolicGesture, natural_times, stroke_length

SPANS_S = (1.0, 1.5, 2.0, 3.0, 4.0, 6.0, 8.0, 12.0, 16.0, 24.0, 40.0, 60.0, 100.0, 160.0)
"""How long a time line may be [s]."""

FREE_SHARE = 0.1
"""Part of a time line that stays free behind the gesture, at least."""


def phase_spans(gesture: SymbolicGesture) -> dict[Phase, tuple[float, float]]:
    """Return when each phase begins and ends, from the start of the gesture [s]."""
    times = natural_times(gesture)
    assert times.relax is not None, "natural times are all known"
    assert times.end is not None, "natural times are all known"
    return {
        "preparation": (times.start, times.ready),
        "stroke": (times.stroke_start, times.stroke_end),
        "hold": (times.stroke_end, times.relax),
        "retraction": (times.relax, times.end),
    }


def duration(gesture: SymbolicGesture) -> float:
    """Return how long a gesture lasts [s]."""
    return phase_spans(gesture)["retraction"][1]


def phase_at(gesture: SymbolicGesture, time: float) -> Phase:
    """Return the phase at a time [s]; after the gesture the last one."""
    spans = phase_spans(gesture)
    return next((phase for phase, (_, end) in spans.items() if time < end), "retraction")


def period(gesture: SymbolicGesture) -> float:
    """Return the time from one performance of the stroke to the next [s]."""
    return stroke_length(gesture) / Repeats.of(gesture).periods


def stroke_for(gesture: SymbolicGesture, length: float) -> float:
    """Return how long a stroke is if all performances of it are to take `length` [s]."""
    repeats = Repeats.of(gesture)
    return length * repeats.share / repeats.periods


def time_of(gesture: SymbolicGesture, at: float) -> float:
    """Return when a moment of the first stroke, 0…1, is [s]."""
    return gesture.preparation + at * gesture.stroke


def moment_at(gesture: SymbolicGesture, time: float) -> float:
    """Return the moment of the first stroke at a time [s]; outside of it, not within 0…1."""
    return (time - gesture.preparation) / gesture.stroke


def nearest_moment(gesture: SymbolicGesture, time: float) -> float:
    """Return the moment of any stroke at a time [s], 0…1.

    >>> nearest_moment(SymbolicGesture("", preparation=0.5, stroke=0.2), 0.55)
    0.25
    """
    start, end = phase_spans(gesture)["stroke"]
    if not start <= time < end:
        return 0.0 if time < start else 1.0
    return round(min((time - start) % period(gesture) / gesture.stroke, 1.0), 4)


def time_line_span(gesture: SymbolicGesture) -> float:
    """Return how many seconds a time line shows [s]."""
    needed = duration(gesture) * (1.0 + FREE_SHARE)
    return next((each for each in SPANS_S if each >= needed), needed)
