"""Box plots as SVG, for a page that holds all it shows."""

import math
from collections.abc import Callable, Sequence
from html import escape

import numpy as np
from numpy.typing import NDArray

WIDTH, ROW, LEFT, RIGHT, BELOW = 720, 46, 190, 24, 40
"""Width of a plot, height of a row, and room beside and below [px]."""

WHISKER = 1.5
"""Whiskers reach to the last value within so many quartile ranges of the box (J. Tukey, 1977)."""

MAX_POINTS = 400
"""A row with more values shows its box alone: the points would be a smear."""


def box_plot(
    groups: Sequence[tuple[str, Sequence[float]]],
    label: str,
    span: tuple[float, float] | None = None,
) -> str:
    """Return a plot with a box for each group, and a point for each value.

    Parameters
    ----------
    groups
        Name and values of each; those without values have an empty row.
    label
        What the axis measures, with its unit.
    span
        Where the axis begins and ends; None for what the values need.
    """
    everything = [value for _, values in groups for value in values]
    low, high, ticks = axis(everything, span)
    height = ROW * len(groups) + BELOW
    scale = (WIDTH - LEFT - RIGHT) / (high - low)

    def x(value: float) -> float:
        return round(LEFT + (value - low) * scale, 1)

    parts = [
        f'<svg viewBox="0 0 {WIDTH} {height}" role="img" aria-label="{escape(label, quote=True)}">'
    ]
    for tick in ticks:
        parts.append(
            f'<line class="grid" x1="{x(tick)}" x2="{x(tick)}" y1="0" y2="{height - BELOW}"/>'
        )
        parts.append(f'<text class="tick" x="{x(tick)}" y="{height - BELOW + 16}">{tick:g}</text>')
    middle = (LEFT + WIDTH - RIGHT) / 2
    parts.append(f'<text class="tick" x="{middle:g}" y="{height - 6}">{escape(label)}</text>')
    for number, (name, values) in enumerate(groups):
        y = ROW * number + ROW / 2
        parts.append(f'<text class="name" x="{LEFT - 12}" y="{y + 4:g}">{escape(name)}</text>')
        if len(values):
            parts += _box(np.sort(np.asarray(values, float)), x, y)
    return "".join([*parts, "</svg>"])


def _box(values: NDArray[np.float64], x: Callable[[float], float], y: float) -> list[str]:
    """Return the box, whiskers and points of a row, from sorted values."""
    first, median, third = (float(each) for each in np.quantile(values, (0.25, 0.5, 0.75)))
    reach = WHISKER * (third - first)
    inside = values[(values >= first - reach) & (values <= third + reach)]
    low, high = float(inside[0]), float(inside[-1])
    parts = [
        f'<line class="whisker" x1="{x(low)}" x2="{x(high)}" y1="{y:g}" y2="{y:g}"/>',
        f'<rect class="box" x="{x(first)}" width="{max(1.0, x(third) - x(first)):.1f}" '
        f'y="{y - 11:g}" height="22"/>',
        f'<line class="median" x1="{x(median)}" x2="{x(median)}" y1="{y - 11:g}" y2="{y + 11:g}"/>',
    ]
    if len(values) <= MAX_POINTS:
        # Values that are equal are one above the other, in the same way on every computer.
        for index, value in enumerate(values):
            shift = 8.0 * math.sin(2.4 * index)
            parts.append(
                f'<circle class="point" cx="{x(float(value))}" cy="{y + shift:.1f}" r="2.2"/>'
            )
    return parts


def axis(
    values: Sequence[float], span: tuple[float, float] | None
) -> tuple[float, float, list[float]]:
    """Return where an axis begins and ends, and its ticks, for values or a span."""
    low, high = span or (min(values, default=0.0), max(values, default=1.0))
    if high - low < 1e-9:
        low, high = low - 0.5, high + 0.5
    size = 10.0 ** math.floor(math.log10((high - low) / 5.0))
    step = next(size * each for each in (1, 2, 5, 10) if (high - low) / (size * each) <= 7.0)
    first, last = math.floor(low / step + 1e-9), math.ceil(high / step - 1e-9)
    ticks = [round(step * index, 10) for index in range(first, last + 1)]
    margin = 0.02 * (ticks[-1] - ticks[0])
    return ticks[0] - margin, ticks[-1] + margin, ticks
