"""A table of a report, and how figures read in it."""

import math
from dataclasses import dataclass


@dataclass(frozen=True)
class ReportTable:
    """A table as it is printed."""

    title: str
    columns: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]
    """A text for each column."""

    note: str = ""
    """What is to be said under it."""


def figure(value: float | None, digits: int = 2) -> str:
    """Return a number, or a dash where there is none.

    >>> figure(-0.654), figure(float("nan"))
    ('−0.65', '–')
    """
    if value is None or not math.isfinite(value):
        return "–"
    return f"{value:.{digits}f}".replace("-", "−")


def interval(bounds: tuple[float, float], digits: int = 2) -> str:
    """Return an interval: "[1.20, 3.40]"; "–" for one that is not known (NaN)."""
    if any(map(math.isnan, bounds)):
        return "–"
    return f"[{figure(bounds[0], digits)}, {figure(bounds[1], digits)}]"


def p_value(p: float) -> str:
    """Return a probability as journals print it.

    >>> p_value(0.0004), p_value(0.0312), p_value(0.5)
    ('< .001', '.031', '.500')
    """
    return "< .001" if p < 0.001 else f"{p:.3f}".removeprefix("0")


def percent(share: float, digits: int = 1) -> str:
    """Return a share in per cent: "91.7 %"."""
    return f"{100 * share:.{digits}f} %"
