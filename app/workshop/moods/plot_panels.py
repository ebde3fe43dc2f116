"""The panels of the mood plot: over time, and the plane of valence and arousal."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.lines import Line2D
from matplotlib.ticker import MaxNLocator

from cubeling.affect import LabelSet
from cubeling.app.workshop.moods.colors import (
    BORDER_COLOR,
    CURVE_STYLES,
    GRID_COLOR,
    OBSERVED_COLOR,
    SECONDARY_COLOR,
    TEXT_COLOR,
    action_color,
    label_color,
)
from cubeling.app.workshop.moods.history import EmotionTrack, MoodHistory
from cubeling.app.workshop.moods.plot_layout import EmotionCurve, fits, value_axis, width_pt
from cubeling.app.workshop.moods.regions import label_position, regions, runs
from cubeling.app.workshop.moods.robot_traces import RobotTraces

ACKNOWLEDGED_STYLE: dict[str, Any] = {
    "color": CURVE_STYLES[1][0],
    "linewidth": 1.6,
    "linestyle": (0, (4.0, 4.0)),
}
"""The line of the acknowledged emotion, for matplotlib."""


def draw_bands(axes: Axes, track: EmotionTrack, labels: LabelSet, *, named: bool) -> None:
    """Colour the time of each label, and write the label below it if there is room."""
    found = runs(track.labels, track.times)
    _draw_runs(axes, found, (-1.0, 2.0), [label_color(labels, label) for label, _, _ in found])
    for label, start, end in found if named else ():
        if fits(axes, label, start, end):
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
    axes.vlines(starts, bottom, bottom + height, color=BORDER_COLOR, linewidth=0.8, zorder=1)


def draw_robot(axes: Axes, axis: int, robot: RobotTraces) -> None:
    """Draw what the robot showed, and as steps what it acknowledged; NaN interrupts a line."""
    observed, acknowledged = robot.observed, robot.acknowledged
    axes.plot(observed.times, observed.emotion[:, axis], color=OBSERVED_COLOR, linewidth=5.0)
    if len(acknowledged.times):
        times = np.append(acknowledged.times, max(axes.get_xlim()[1], acknowledged.times[-1]))
        values = np.append(acknowledged.emotion[:, axis], acknowledged.emotion[-1, axis])
        axes.plot(times, values, drawstyle="steps-post", zorder=3, **ACKNOWLEDGED_STYLE)


def draw_actions(axes: Axes, history: MoodHistory) -> None:
    """Draw what the character did, with its intensity or speed as a line."""
    found = [run for run in runs(history.actions, history.recorded.times) if run[0]]
    _draw_runs(axes, found, (-1.25, 2.5), [action_color(name, pale=True) for name, _, _ in found])
    _draw_runs(axes, found, (1.25, 1.0), [action_color(name) for name, _, _ in found])
    for name, start, end in found:
        if fits(axes, name, start, end):
            axes.text((start + end) / 2, 1.72, name, ha="center", va="center", fontweight="bold")
    if history.has_intensity:
        label, ends = "intensity", ("−1", "+1")
        values = np.array([command.weight for command in history.commands])
    else:
        label, ends = "Speed", ("0", "5")
        values = np.clip([command.speed for command in history.commands], 0, 5) / 2.5 - 1
    axes.plot(history.recorded.times, values, color=TEXT_COLOR, linewidth=1.4)
    axes.set_ylim(-1.25, 2.25)
    axes.set_yticks([-1.0, 1.0], ends)
    axes.set_ylabel(label)
    axes.yaxis.set_label_coords(-46 / width_pt(axes), 0.36)
    axes.xaxis.set_major_locator(MaxNLocator(nbins=10, steps=[1, 2, 5, 10]))
    axes.set_xlabel("time [s]")
    axes.spines[:].set_color(GRID_COLOR)


def draw_plane(axes: Axes, labels: LabelSet, curves: Sequence[EmotionCurve]) -> None:
    """Draw the regions of the labels, and the path of each emotion through them."""
    found = regions(labels)
    for label, polygon in found.items():
        color = label_color(labels, label)
        axes.fill(*polygon.T, facecolor=color, edgecolor=BORDER_COLOR, linewidth=0.8, zorder=0)
    value_axis(axes, "valence", horizontal=True)
    value_axis(axes, "arousal")
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
    ends["color"] = TEXT_COLOR
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
            word, corner, offset, "axes fraction", "offset points", color=SECONDARY_COLOR, **style
        )
