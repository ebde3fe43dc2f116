"""Line plots over time as SVG, for a page that holds all it shows."""

from collections.abc import Callable, Sequence
from html import escape

import numpy as np
from numpy.typing import NDArray

from cubeling.app.workshop.pages.box_plot import axis

WIDTH, HEIGHT, LEFT, RIGHT, BELOW, ABOVE = 720, 190, 60, 16, 40, 22
"""Size of a plot, and the room around its curves [px]."""

MAX_POINTS = 1200
"""Points of a curve; of more, the least and the greatest of each group are drawn."""

COLORS = ("#2b5c9e", "#c0504d", "#4f8f3a")

Scale = Callable[[float], float]

Curve = tuple[str, NDArray[np.float64], NDArray[np.float64]]
"""Name, times [s] and values; NaN breaks it."""


def line_plot(
    curves: Sequence[Curve],
    label: str,
    span: tuple[float, float] | None = None,
    bands: Sequence[tuple[float, float]] = (),
) -> str:
    """Return a plot of curves over time.

    Parameters
    ----------
    curves
        At most three.
    label
        What they measure, with its unit.
    span
        Where the upward axis begins and ends; None for what the values need.
    bands
        Beginnings and ends [s] of what is shaded.
    """
    times = [float(t) for _, each, _ in curves for t in each[[0, -1]]] if curves else []
    values = [float(v) for _, _, each in curves for v in each[np.isfinite(each)]]
    left, right = min(times, default=0.0), max(times, default=1.0)
    right = max(right, left + 1e-3)
    time_ticks = [tick for tick in axis([left, right], None)[2] if left <= tick <= right]
    low, high, ticks = axis(values, span)

    def x(time: float) -> float:
        return round(LEFT + (time - left) / (right - left) * (WIDTH - LEFT - RIGHT), 1)

    def y(value: float) -> float:
        return round(ABOVE + (high - value) / (high - low) * (HEIGHT - ABOVE - BELOW), 1)

    bottom = HEIGHT - BELOW
    name = escape(label, quote=True)
    parts = [f'<svg viewBox="0 0 {WIDTH} {HEIGHT}" role="img" aria-label="{name}">']
    for start, end in bands:
        width = max(1.0, x(end) - x(start))
        parts.append(
            f'<rect class="band" x="{x(start)}" width="{width:.1f}" y="{ABOVE}" '
            f'height="{bottom - ABOVE}"/>'
        )
    for tick in ticks:
        parts.append(
            f'<line class="grid" x1="{LEFT}" x2="{WIDTH - RIGHT}" y1="{y(tick)}" y2="{y(tick)}"/>'
            f'<text class="name" x="{LEFT - 8}" y="{y(tick) + 4}">{tick:g}</text>'
        )
    for tick in time_ticks:
        parts.append(f'<text class="tick" x="{x(tick)}" y="{bottom + 16}">{tick:g}</text>')
    middle = (LEFT + WIDTH - RIGHT) / 2
    parts.append(f'<text class="tick" x="{middle:g}" y="{HEIGHT - 6}">time [s]</text>')
    parts.append(f'<text class="title" x="{LEFT}" y="14">{escape(label)}</text>')
    for number, (title, when, curve) in enumerate(curves):
        color = COLORS[number]
        path = _path(*_thinned(when, curve), x, y)
        parts.append(f'<path d="{path}" fill="none" stroke="{color}" stroke-width="1.6"/>')
        if len(curves) > 1:
            place = WIDTH - RIGHT - 120 * (len(curves) - 1 - number)
            parts.append(
                f'<text class="name" x="{place}" y="14" fill="{color}" '
                f'style="fill: {color}">{escape(title)}</text>'
            )
    return "".join([*parts, "</svg>"])


def _thinned(
    times: NDArray[np.float64], values: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return at most `MAX_POINTS` of a curve, its peaks among them."""
    if len(values) <= MAX_POINTS:
        return times, values
    chosen = set()
    for group in np.array_split(np.arange(len(values)), MAX_POINTS // 2):
        filled = np.where(np.isfinite(values[group]), values[group], 0.0)
        chosen |= {int(group[int(filled.argmin())]), int(group[int(filled.argmax())])}
    kept = np.array(sorted(chosen))
    return times[kept], values[kept]


def _path(times: NDArray[np.float64], values: NDArray[np.float64], x: Scale, y: Scale) -> str:
    parts, joined = [], False
    for time, value in zip(times, values, strict=True):
        if np.isfinite(value):
            parts.append(f"{'L' if joined else 'M'}{x(float(time))} {y(float(value))}")
        joined = bool(np.isfinite(value))
    return "".join(parts)
