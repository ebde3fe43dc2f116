"""The picture of a session's moods: over time on the left, as a way in the plane on the right."""

from collections.abc import Sequence

import numpy as np

from affect.labels import LabelSet
from app.moods.captions import heading, legend, shares
from app.moods.curves import Curve, curves_of, spans
from app.moods.drawing import Array, Drawing, text_width
from app.moods.history import Felt, History
from app.moods.plane import draw_plane
from app.moods.tints import FAINT, INK, LINES, OBSERVED, QUIET, RULE, action_tint, tint
from app.moods.wire import Trace, Wire

WIDTH, HEIGHT = 1120.0, 668.0
LEFT, RIGHT = 70.0, 710.0
VALENCE, AROUSAL, ACTION = (112.0, 306.0), (334.0, 474.0), (500.0, 574.0)
"""Top and bottom of each panel."""

PLANE = (790.0, 112.0, 1090.0, 412.0)
"""Left, top, right and bottom of the plane."""


def draw(history: History, again: Sequence[Felt], wire: Wire, labels: LabelSet) -> Drawing:
    """Draw a session.

    Parameters
    ----------
    history
        What was done, and what was felt of it.
    again
        What others would have felt of it; without, the recorded feeling and the robot are drawn.
    wire
        What the robot made of it.
    labels
        The words whose regions and bands are drawn: those of the first curve.
    """
    drawing = Drawing(WIDTH, HEIGHT, f"Moods of {history.name}")
    curves = curves_of(history, again)
    first = curves[0].felt
    heading(drawing, LEFT, history, again)
    start, end = float(first.times[0]), float(first.times[-1])
    axes = _Axes(start, max(end, start + 1e-3))
    shown = Wire(*_NOTHING) if again else wire
    for panel, axis, name in ((VALENCE, 0, "valence"), (AROUSAL, 1, "arousal")):
        _bands(drawing, axes, panel, first, labels, named=axis == 0)
        _grid(drawing, axes, panel, name)
        _traces(drawing, axes, panel, axis, curves, shown)
    _actions(drawing, axes, history)
    _clock(drawing, axes)
    legend(drawing, LEFT, curves, shown)
    ways = [(curve.felt, curve.colour, curve.dashes, curve.width) for curve in curves]
    shares(drawing, PLANE[0], 504.0, curves)
    draw_plane(drawing, PLANE, labels, ways)
    return drawing


_EMPTY = Trace(np.zeros(0), np.zeros((0, 2)), ())
_NOTHING = (_EMPTY, _EMPTY, np.zeros(0))


class _Axes:
    """From seconds and −1…1 to places on the paper."""

    def __init__(self, start: float, end: float) -> None:
        self.start, self.end = start, end

    def x(self, time: Array | float) -> Array:
        """Return how far to the right a time [s] lies."""
        return LEFT + (np.asarray(time) - self.start) / (self.end - self.start) * (RIGHT - LEFT)

    def y(self, value: Array | float, panel: tuple[float, float]) -> Array:
        """Return how far down a value, −1…1, lies in a panel."""
        return panel[1] - (np.asarray(value) + 1) / 2 * (panel[1] - panel[0])


def _bands(
    drawing: Drawing,
    axes: _Axes,
    panel: tuple[float, float],
    felt: Felt,
    labels: LabelSet,
    *,
    named: bool,
) -> None:
    """Colour the time that each label lasted, and write it below if there is room."""
    for label, start, end in spans(felt.labels, felt.times):
        left, right = float(axes.x(start)), float(axes.x(end))
        drawing.box(left, panel[0], right, panel[1], tint(labels, label))
        if start > axes.start:
            drawing.line([(left, panel[0]), (left, panel[1])], FAINT, 0.8)
        if named and text_width(label, 11) < right - left:
            drawing.text(label, (left + right) / 2, panel[1] + 17, 11, INK, 0.5, bold=True)


def _grid(drawing: Drawing, axes: _Axes, panel: tuple[float, float], name: str) -> None:
    for value in (-1.0, -0.5, 0.0, 0.5, 1.0):
        y = float(axes.y(value, panel))
        drawing.line([(LEFT, y), (RIGHT, y)], QUIET if value == 0 else RULE, 0.7)
        drawing.text(
            f"{value:+g}".replace("-", "−").replace("+0", "0"), LEFT - 7, y + 4, 11, INK, 1.0
        )
    middle = (panel[0] + panel[1]) / 2
    drawing.text(f"{name} [1]", 24, middle, 12.5, INK, 0.5, upright=True)


def _traces(
    drawing: Drawing,
    axes: _Axes,
    panel: tuple[float, float],
    axis: int,
    curves: Sequence[Curve],
    wire: Wire,
) -> None:
    def place(times: Array, values: Array) -> Array:
        return np.stack([axes.x(times), axes.y(values, panel)], axis=1)

    within = (wire.observed.times >= axes.start) & (wire.observed.times <= axes.end)
    seen = place(wire.observed.times[within], wire.observed.emotion[within, axis])
    drawing.line(seen, OBSERVED, 5.0)
    for curve in reversed(curves):
        points = place(curve.felt.times, curve.felt.emotion[:, axis])
        drawing.line(points, curve.colour, curve.width, curve.dashes)
    steps, values = _steps(axes, wire.acknowledged)
    drawing.line(place(steps, values[:, axis]), LINES[1][0], 1.6, (4.0, 4.0))


def _steps(axes: _Axes, trace: Trace) -> tuple[Array, Array]:
    """Return the corners of a feeling that holds until the next: times (2n,) and values (2n, 2)."""
    ends = np.append(trace.times[1:], axes.end)[: len(trace.times)]
    times = np.stack([trace.times, ends], axis=1).ravel()
    return np.clip(times, axes.start, axes.end), np.repeat(trace.emotion, 2, axis=0)


def _actions(drawing: Drawing, axes: _Axes, history: History) -> None:
    """Draw what the character did as a strip, with its intensity as a line."""
    (top, bottom), times = ACTION, history.felt.times
    for action, start, end in spans(history.actions, times):
        left, right = float(axes.x(start)), float(axes.x(end))
        if not action:
            continue
        drawing.box(left, top, right, top + _NAMES, action_tint(action))
        drawing.box(left, top + _NAMES, right, bottom, action_tint(action, pale=True))
        drawing.line([(left, top), (left, bottom)], FAINT, 0.8)
        if text_width(action, 11) < right - left - 4:
            drawing.text(action, (left + right) / 2, top + 15, 11, INK, 0.5, bold=True)
    corners = [(LEFT, top), (RIGHT, top), (RIGHT, bottom), (LEFT, bottom), (LEFT, top)]
    drawing.line(corners, RULE, 0.8)
    name, low, high, level = _level(history)
    inner = (top + _NAMES + 6, bottom - 6)
    drawing.line(np.stack([axes.x(times), axes.y(level, inner)], axis=1), INK, 1.4)
    drawing.text(high, LEFT - 7, inner[0] + 4, 11, INK, 1.0)
    drawing.text(low, LEFT - 7, inner[1] + 4, 11, INK, 1.0)
    drawing.text(name, 24, (inner[0] + inner[1]) / 2, 12.5, INK, 0.5, upright=True)


_NAMES = 21.0
"""Height of the actions' names above their line."""


def _level(history: History) -> tuple[str, str, str, Array]:
    """Return what the line below the actions is, its ends, and its values as −1…1."""
    if history.about.scenario == "companion":
        return "intensity", "−1", "+1", history.weights
    speeds = np.array([command.speed for command in history.commands])
    return "Speed", "0", "5", np.clip(speeds, 0, 5) / 2.5 - 1


def _clock(drawing: Drawing, axes: _Axes) -> None:
    """Draw the axis of time below everything."""
    bottom = ACTION[1]
    for time in ticks(axes.start, axes.end):
        x = float(axes.x(time))
        drawing.line([(x, bottom), (x, bottom + 4)], INK, 0.8)
        drawing.text(f"{time:g}", x, bottom + 16, 11, INK, 0.5)
    drawing.text("time [s]", (LEFT + RIGHT) / 2, bottom + 33, 12.5, INK, 0.5)


def ticks(start: float, end: float, most: int = 10) -> list[float]:
    """Return round numbers from start to end.

    >>> ticks(0.0, 41.0)
    [0.0, 5.0, 10.0, 15.0, 20.0, 25.0, 30.0, 35.0, 40.0]
    """
    power = 10.0 ** np.floor(np.log10((end - start) / most))
    step = next(power * each for each in (1, 2, 5, 10) if (end - start) / (power * each) <= most)
    first, last = int(np.ceil(start / step - 1e-9)), int(np.floor(end / step + 1e-9))
    return [round(float(step * index), 9) for index in range(first, last + 1)]
