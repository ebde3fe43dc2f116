"""How ugly a simulated board is."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Habits:
    """How ugly a board is."""

    merges: bool = True
    """Whether lines that wait are read as one, and skills broken off by the next byte: BiBoard.
    Otherwise lines wait in order, and a skill is always played to its end: NyBoard."""

    buffer: int = 256
    """Bytes that wait at most; more are lost."""

    answers_query: bool = True
    """Whether "?" is answered with model and version; old boards only echo it."""

    slow: float = 0.03
    """Chance of a line that is taken only after half a second to one and a half."""

    mangled: float = 0.01
    """Chance of an echo that text without an end stands in front of."""

    brown_outs: float = 0.01
    """Chance of a skill in which the battery gives way, and the board starts anew."""

    restless: float = 25.0
    """Mean time between sensor texts, and falls, that nobody asked for [s]; 0 for none."""

    battery_lasts: float = 5400.0
    """Time until the battery is low [s]; somebody changes it ten minutes later."""
