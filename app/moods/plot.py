"""The plot of a session's moods: over time on the left, in the valence-arousal plane on the right.

Needs matplotlib, the extra `[plots]`; only `cubeling mood plot` imports this module.
"""

import itertools
from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import Any

import matplotlib
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.font_manager import FontProperties
from matplotlib.lines import Line2D
from matplotlib.textpath import TextPath
from matplotlib.ticker import FixedLocator, FuncFormatter, MaxNLocator
from numpy.typing import NDArray

from affect.labels import LabelSet
from app.errors import AppError
from app.moods.colors import (
    BORDER,
    CURVES,
    GRID,
    OBSERVED,
    SECONDARY,
    TEXT,
    action_color,
    label_color,
)
from app.moods.history import EmotionTrack, MoodHistory
from app.moods.regions import label_position, regions, runs
from app.moods.robot_traces import RobotTraces

Array = NDArray[np.float64]

WIDTH_PT, HEIGHT_PT = 1120.0, 668.0
TIME_PANELS_PT = (70.0, 710.0)
"""Left and right edge of the panels over time."""

VALENCE_PT, AROUSAL_PT, ACTION_PT = (112.0, 306.0), (334.0, 474.0), (500.0, 574.0)
"""Top and bottom edge of each of them."""

PLANE_PT = (790.0, 112.0, 1090.0, 412.0)
"""Left, top, right and bottom edge of the plane."""

PNG_DPI = 144.0
"""Two pixels for each point."""

MAX_SHARES = 4
"""Moods that are listed with their time, the longest first."""

STYLE: dict[Any, Any] = {
    "font.family": "sans-serif",
    "font.sans-serif": ["DejaVu Sans"],  # matplotlib brings it: the same plot on every machine
    "font.size": 10.0,
    "text.color": TEXT,
    "text.parse_math": False,  # a file name may contain "$"
    "axes.edgecolor": BORDER,
    "axes.labelcolor": TEXT,
    "axes.labelsize": 11.5,
    "axes.linewidth": 0.8,
    "axes.axisbelow": True,
    "xtick.color": TEXT,
    "ytick.color": TEXT,
    "xtick.labelsize": 10.0,
    "ytick.labelsize": 10.0,
    "ytick.major.size": 0.0,
    "lines.scale_dashes": False,
    "lines.dash_capstyle": "butt",
    "path.simplify_threshold": 0.3,  # [pt] of a vector file; an hour stays a small one
    "svg.fonttype": "none",  # text stays text
    "svg.hashsalt": "cubeling",
    "pdf.fonttype": 42,  # TrueType: text can be searched and copied
}

METADATA: dict[str, dict[str, str | None]] = {
    ".svg": {"Date": None, "Creator": "cubeling"},
    ".pdf": {"CreationDate": None, "Creator": "cubeling"},
    ".png": {"Software": "cubeling"},
}
"""Metadata by the suffix of the file, without dates: the same session gives the same bytes."""


@dataclass(frozen=True)
class Curve:
    """One of the emotions that are compared in a plot."""

    track: EmotionTrack
    """Its values."""

    name: str
    """Its name in the legend."""

    color: str
    """Its colour, "#rrggbb"."""

    dashes: tuple[float, ...]
    """Lengths of dash and gap [pt]; empty for a solid line."""

    width: float
    """Width of the line [pt]."""

    @property
    def style(self) -> dict[str, Any]:
        """The line's style for matplotlib."""
        return {"color": self.color, "linewidth": self.width, "linestyle": (0, self.dashes or None)}


def save_plot(
    path: Path,
    history: MoodHistory,
    others: Sequence[EmotionTrack],
    robot: RobotTraces,
    labels: LabelSet,
) -> None:
    """Plot a session into an .svg, .pdf or .png file.

    `others` are the emotions of other personalities; if there are any, the robot is left out. The
    regions and bands of `labels` are drawn, those of the first curve.

    Raises
    ------
    AppError
        The file cannot be written.
    """
    with matplotlib.rc_context(STYLE):
        figure = draw(history, others, robot, labels)
        metadata = {**METADATA[path.suffix.lower()], "Title": printable(f"Moods of {history.name}")}
        try:
            figure.savefig(path, dpi=PNG_DPI if path.suffix == ".png" else 72.0, metadata=metadata)
        except OSError as error:
            raise AppError(f"cannot write '{path}' ({error.strerror}): check the folder") from None


def draw(
    history: MoodHistory, others: Sequence[EmotionTrack], robot: RobotTraces, labels: LabelSet
) -> Figure:
    """Return the figure; see `save_plot`."""
    figure = Figure(figsize=(WIDTH_PT / 72, HEIGHT_PT / 72))
    curves = _curves(history, others)
    first = curves[0].track
    left, right = TIME_PANELS_PT
    actions = _panel(figure, left, ACTION_PT[0], right, ACTION_PT[1])
    start, end = float(first.times[0]), float(first.times[-1])
    actions.set_xlim(start, max(end, start + 1e-3))
    for edges, axis, name in ((VALENCE_PT, 0, "valence"), (AROUSAL_PT, 1, "arousal")):
        axes = _panel(figure, left, edges[0], right, edges[1], sharex=actions)
        _draw_bands(axes, first, labels, named=axis == 0)
        if not others:
            _draw_robot(axes, axis, robot)
        for curve in reversed(curves):
            axes.plot(curve.track.times, curve.track.emotion[:, axis], clip_on=False, **curve.style)
        _value_axis(axes, name)
        axes.tick_params(bottom=False, labelbottom=False)
        axes.spines[:].set_visible(False)
    _draw_actions(actions, history)
    _draw_plane(_panel(figure, *PLANE_PT), labels, curves)
    _write_heading(figure, history, others)
    _write_legend(figure, curves, None if others else robot)
    _write_shares(figure, curves)
    return figure


def _curves(history: MoodHistory, others: Sequence[EmotionTrack]) -> list[Curve]:
    """Return the curves, the first one first: the recorded emotion, or other personalities'."""
    if not others:
        return [Curve(history.recorded, "felt, and asked of the robot", TEXT, (), 1.8)]
    styles = itertools.cycle(CURVES)
    curves = [Curve(track, printable(track.personality), *next(styles), 2.0) for track in others]
    return [*curves, Curve(history.recorded, "as recorded", SECONDARY, (1.5, 2.5), 1.2)]


def _panel(
    figure: Figure, left: float, top: float, right: float, bottom: float, **options: Any
) -> Axes:
    """Return axes between four edges [pt], counted from the top left corner."""
    width, height = (right - left) / WIDTH_PT, (bottom - top) / HEIGHT_PT
    return figure.add_axes((left / WIDTH_PT, 1 - bottom / HEIGHT_PT, width, height), **options)


def _value_axis(axes: Axes, name: str, *, horizontal: bool = False) -> None:
    """Let an axis run from −1 to 1, with a grid."""
    axis = axes.xaxis if horizontal else axes.yaxis
    (axes.set_xlim if horizontal else axes.set_ylim)(-1.0, 1.0)
    axis.set_major_locator(FixedLocator([-1.0, -0.5, 0.0, 0.5, 1.0]))
    axis.set_major_formatter(FuncFormatter(lambda value, _: _signed(value)))
    axis.set_label_text(f"{name} [1]")
    if not horizontal:
        axis.set_label_coords(-46 / _width_pt(axes), 0.5)
    axis.grid(True, color=GRID, linewidth=0.7)
    (axes.axvline if horizontal else axes.axhline)(0.0, color=SECONDARY, linewidth=0.7, zorder=1)


def _signed(value: float) -> str:
    """Return a number with its sign, and a real minus.

    >>> [_signed(value) for value in (-0.5, 0.0, 1.0)]
    ['−0.5', '0', '+1']
    """
    return f"{value:+g}".replace("-", "−").replace("+0.5", "0.5") if value else "0"


def _draw_bands(axes: Axes, track: EmotionTrack, labels: LabelSet, *, named: bool) -> None:
    """Colour the time of each label, and write the label below it if there is room."""
    found = runs(track.labels, track.times)
    _draw_runs(axes, found, (-1.0, 2.0), [label_color(labels, label) for label, _, _ in found])
    for label, start, end in found if named else ():
        if _fits(axes, label, start, end):
            axes.annotate(
                label,
                ((start + end) / 2, -1.0),
                (0, -14),
                textcoords="offset points",
                ha="center",
                va="center",
                annotation_clip=False,
                fontweight="bold",
            )


def _draw_runs(
    axes: Axes,
    found: Sequence[tuple[str, float, float]],
    bottom_height: tuple[float, float],
    colors: Sequence[str],
) -> None:
    """Draw runs as coloured bars with a line at each start."""
    spans = [(start, end - start) for _, start, end in found]
    axes.broken_barh(spans, bottom_height, facecolors=colors, linewidth=0, zorder=0)
    bottom, height = bottom_height
    starts = [start for _, start, _ in found if start > axes.get_xlim()[0]]
    axes.vlines(starts, bottom, bottom + height, color=BORDER, linewidth=0.8, zorder=1)


def _draw_robot(axes: Axes, axis: int, robot: RobotTraces) -> None:
    """Draw what the robot showed, and as steps what it acknowledged; NaN interrupts a line."""
    observed, acknowledged = robot.observed, robot.acknowledged
    axes.plot(observed.times, observed.emotion[:, axis], color=OBSERVED, linewidth=5.0)
    if len(acknowledged.times):
        times = np.append(acknowledged.times, max(axes.get_xlim()[1], acknowledged.times[-1]))
        values = np.append(acknowledged.emotion[:, axis], acknowledged.emotion[-1, axis])
        axes.plot(times, values, drawstyle="steps-post", zorder=3, **_ACKNOWLEDGED)


_ACKNOWLEDGED: dict[str, Any] = {
    "color": CURVES[1][0],
    "linewidth": 1.6,
    "linestyle": (0, (4.0, 4.0)),
}


def _draw_actions(axes: Axes, history: MoodHistory) -> None:
    """Draw what the character did, with its intensity or speed as a line."""
    found = [run for run in runs(history.actions, history.recorded.times) if run[0]]
    _draw_runs(axes, found, (-1.25, 2.5), [action_color(name, pale=True) for name, _, _ in found])
    _draw_runs(axes, found, (1.25, 1.0), [action_color(name) for name, _, _ in found])
    for name, start, end in found:
        if _fits(axes, name, start, end):
            axes.text((start + end) / 2, 1.72, name, ha="center", va="center", fontweight="bold")
    if history.info.options.scenario == "companion":
        label, ends = "intensity", ("−1", "+1")
        values = np.array([command.weight for command in history.commands])
    else:
        label, ends = "Speed", ("0", "5")
        values = np.clip([command.speed for command in history.commands], 0, 5) / 2.5 - 1
    axes.plot(history.recorded.times, values, color=TEXT, linewidth=1.4)
    axes.set_ylim(-1.25, 2.25)
    axes.set_yticks([-1.0, 1.0], ends)
    axes.set_ylabel(label)
    axes.yaxis.set_label_coords(-46 / _width_pt(axes), 0.36)
    axes.xaxis.set_major_locator(MaxNLocator(nbins=10, steps=[1, 2, 5, 10]))
    axes.set_xlabel("time [s]")
    axes.spines[:].set_color(GRID)


def _draw_plane(axes: Axes, labels: LabelSet, curves: Sequence[Curve]) -> None:
    """Draw the regions of the labels, and the path of each emotion through them."""
    found = regions(labels)
    for label, polygon in found.items():
        color = label_color(labels, label)
        axes.fill(*polygon.T, facecolor=color, edgecolor=BORDER, linewidth=0.8, zorder=0)
    _value_axis(axes, "valence", horizontal=True)
    _value_axis(axes, "arousal")
    for curve in reversed(curves):
        axes.plot(*curve.track.emotion.T, clip_on=False, **curve.style)
    for label, polygon in found.items():
        axes.text(
            *label_position(labels, label, polygon),
            label,
            ha="center",
            va="center",
            fontsize=10.5 if len(found) <= 10 else 7.5,
            fontweight="bold",
            zorder=4,
        )
    ends: dict[str, Any] = {"marker": "o", "markersize": 8.0, "linestyle": "", "clip_on": False}
    for curve in reversed(curves):
        (x, y), (x2, y2) = curve.track.emotion[[0, -1]].tolist()
        axes.plot(x, y, markerfacecolor="white", markeredgecolor=curve.color, zorder=5, **ends)
        axes.plot(x2, y2, markerfacecolor=curve.color, markeredgecolor="white", zorder=5, **ends)
    ends["color"] = TEXT
    axes.legend(
        [Line2D([], [], markerfacecolor="white", **ends), Line2D([], [], **ends)],
        ["first", "last"],
        loc="upper left",
        bbox_to_anchor=(-0.02, -0.14),
        ncols=2,
        frameon=False,
        handletextpad=0.2,
        columnspacing=1.2,
    )
    across, up = {"va": "baseline"}, {"ha": "center", "rotation": 90}
    for word, corner, offset, style in (
        ("unpleasant", (0, 0), (0, -29), {"ha": "left", **across}),
        ("pleasant", (1, 0), (0, -29), {"ha": "right", **across}),
        ("calm", (0, 0), (-46, 0), {"va": "bottom", **up}),
        ("excited", (0, 1), (-46, 0), {"va": "top", **up}),
    ):
        axes.annotate(
            word, corner, offset, "axes fraction", "offset points", color=SECONDARY, **style
        )


def _write_heading(figure: Figure, history: MoodHistory, others: Sequence[EmotionTrack]) -> None:
    """Write which session it is, how it was recorded, and whose emotions are compared."""
    info, own = history.info, "the scenario's own personality"
    parts = [f"scenario {info.options.scenario}", f"{info.duration:.1f} s"]
    parts.append(f"recorded with {info.options.personality or own}")
    if others:
        names = [track.personality for track in others]
        listed = " and ".join(filter(None, (", ".join(names[:-1]), names[-1])))
        parts.append(f"felt again by {listed}")
        if len(names) > 1:
            parts.append(f"bands: {names[0]}")
    left = TIME_PANELS_PT[0]
    _write(figure, left, 42, f"Moods of {history.name}", fontsize=19, fontweight="bold")
    _write(figure, left, 64, "   ·   ".join(parts), fontsize=11, color=SECONDARY)


def _write_legend(figure: Figure, curves: Sequence[Curve], robot: RobotTraces | None) -> None:
    """Name the lines in a row above the panels."""
    handles = [Line2D([], [], label=curve.name, **curve.style) for curve in curves]
    if robot is not None and len(robot.acknowledged.times):
        median_ms = 1e3 * float(np.median(robot.delays)) if len(robot.delays) else 0.0
        late = f" (median {median_ms:.0f} ms later)" if median_ms >= 0.5 else ""
        handles.append(Line2D([], [], label=f"acknowledged{late}", **_ACKNOWLEDGED))
    if robot:
        handles.append(Line2D([], [], label="observed on the robot", color=OBSERVED, linewidth=5.0))
    figure.legend(
        handles=handles,
        loc="center left",
        bbox_to_anchor=(TIME_PANELS_PT[0] / WIDTH_PT, 1 - 91 / HEIGHT_PT),
        ncols=len(handles),
        frameon=False,
        borderpad=0.0,
        borderaxespad=0.0,
        handlelength=2.8,
        columnspacing=2.4,
    )


def _write_shares(figure: Figure, curves: Sequence[Curve]) -> None:
    """Write how long each label lasted."""
    x, y = PLANE_PT[0], 504.0
    _write(figure, x, y, "Time in each mood", fontweight="bold", fontsize=10.5)
    for curve in curves:
        if len(curves) > 1:
            y += 16
            _write(figure, x, y, curve.name, color=SECONDARY, fontsize=9)
        y += 13 if len(curves) > 1 else 18
        seconds: dict[str, float] = {}
        for label, start, end in runs(curve.track.labels, curve.track.times):
            seconds[label] = seconds.get(label, 0.0) + end - start
        longest = sorted(seconds.items(), key=lambda item: -item[1])[:MAX_SHARES]
        line = " · ".join(f"{label} {length:.1f} s" for label, length in longest)
        _write(figure, x, y, line, fontsize=9)


def _write(figure: Figure, x: float, y: float, words: str, **style: Any) -> None:
    """Write a line whose baseline starts at a point [pt from the top left corner]."""
    figure.text(x / WIDTH_PT, 1 - y / HEIGHT_PT, printable(words), va="baseline", **style)


def _fits(axes: Axes, word: str, start: float, end: float) -> bool:
    """Return whether a bold word fits between two times."""
    first, last = axes.get_xlim()
    return _word_width_pt(word) + 4 < (end - start) / (last - first) * _width_pt(axes)


def _width_pt(axes: Axes) -> float:
    return float(axes.get_position().width * WIDTH_PT)


@lru_cache(maxsize=256)
def _word_width_pt(word: str) -> float:
    path = TextPath((0, 0), word, size=STYLE["font.size"], prop=FontProperties(weight="bold"))
    return float(path.get_extents().width)


def printable(words: str) -> str:
    r"""Return words with "?" for every character that cannot be printed, as in an odd file name.

    >>> printable("a\x00b\udcffc")
    'a?b?c'
    """
    return "".join(letter if letter.isprintable() else "?" for letter in words)
