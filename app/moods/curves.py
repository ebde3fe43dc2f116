"""The feelings that are compared in one picture, and how each is told from the others."""

import itertools
from collections.abc import Sequence
from dataclasses import dataclass

from app.moods.drawing import Array
from app.moods.history import Felt, History
from app.moods.tints import INK, LINES, QUIET


@dataclass(frozen=True)
class Curve:
    """One feeling among several."""

    felt: Felt
    """What is drawn."""

    name: str
    """What the legend calls it."""

    colour: str
    """Colour, "#rrggbb"."""

    dashes: tuple[float, ...]
    """So that it can be told from others without colour."""

    width: float
    """How thick."""


def curves_of(history: History, again: Sequence[Felt]) -> list[Curve]:
    """Return the curves of a picture, the first first: what was recorded, or who felt again."""
    if not again:
        return [Curve(history.felt, "felt, and asked of the robot", INK, (), 1.8)]
    styles = itertools.cycle(LINES)
    curves = [Curve(felt, felt.who, *next(styles), 2.0) for felt in again]
    return [*curves, Curve(history.felt, "as recorded", QUIET, (1.5, 2.5), 1.2)]


def spans(names: Sequence[str], times: Array) -> list[tuple[str, float, float]]:
    """Return (name, start, end [s]) for every run of the same name; each ends where one begins."""
    starts = [0] + [i for i in range(1, len(names)) if names[i] != names[i - 1]]
    ends = [float(times[start]) for start in starts[1:]] + [float(times[-1])]
    return [
        (names[start], float(times[start]), end) for start, end in zip(starts, ends, strict=True)
    ]
