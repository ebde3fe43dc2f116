"""A gesture read off a recording."""

from characters.behaviour.gestures.gesture import SymbolicGesture
from characters.errors import CharacterError


def imported(recording: str, start: float, end: float) -> SymbolicGesture:
    """Return the gesture in a span of a recording [s]."""
    raise CharacterError(f"{recording}: recordings cannot be imported yet")
