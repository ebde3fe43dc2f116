"""The plot of a session's moods: over time on the left, in the valence-arousal plane on the right.

Needs matplotlib, the extra `[plots]`; only `cubeling mood plot` imports this module.
"""

import itertools
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

import matplotlib
import numpy as np
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from cubeling.affect import LabelSet
from cubeling.app.errors import AppError
from cubeling.app.workshop.moods.colors import (
    CURVE_STYLES,
    OBSERVED_COLOR,
    SECONDARY_COLOR,
    TEXT_COLOR,
)
from cubeling.app.workshop.moods.history import EmotionTrack, MoodHistory
from cubeling.app.workshop.moods.plot_layout import (
    ACTION_PT,
    AROUSAL_PT,
    HEIGHT_PT,
    MATPLOTLIB_STYLE,
    PLANE_PT,
    TIME_PANELS_PT,
    VALENCE_PT,
    WIDTH_PT,
    EmotionCurve,
    panel,
    printable,
    value_axis,
    write_line,
)
from cubeling.app.workshop.moods.plot_panels import (
    ACKNOWLEDGED_STYLE,
    draw_actions,
    draw_bands,
    draw_plane,
    draw_robot,
)
from cubeling.app.workshop.moods.regions import runs
from cubeling.app.workshop.moods.robot_traces import RobotTraces
from cubeling.files import whole_file

PNG_DPI = 144.0
"""Two pixels for each point."""

MAX_SHARES = 4
"""Moods that are listed with their time, the longest first."""

FILE_METADATA: dict[str, dict[str, str | None]] = {
    ".svg": {"Date": None, "Creator": "cubeling"},
    ".pdf": {"CreationDate": None, "Creator": "cubeling"},
    ".png": {"Software": "cubeling"},
}
"""Metadata by the suffix of the file, without dates: the same session gives the same bytes."""


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
    with matplotlib.rc_context(MATPLOTLIB_STYLE):
        write_figure(draw(history, others, robot, labels), path, f"Moods of {history.name}", 72.0)


def write_figure(figure: Figure, path: Path, title: str, vector_dpi: float = PNG_DPI) -> None:
    """Write a figure to an .svg, .pdf or .png file; an existing file is replaced at the end only.

    `vector_dpi` is the resolution of pictures in the first two.

    Raises
    ------
    AppError
        The file cannot be written.
    """
    suffix = path.suffix.lower()
    metadata = {**FILE_METADATA[suffix], "Title": printable(title)}
    with whole_file(path, AppError) as partial:
        dpi = PNG_DPI if suffix == ".png" else vector_dpi
        figure.savefig(partial, dpi=dpi, metadata=metadata)


@contextmanager
def titled_figure(
    path: Path, title: str, size_in: tuple[float, float], title_size: float | None = None
) -> Iterator[Figure]:
    """Give an empty figure in our style under a title, and write it when it is drawn.

    `size_in` is its width and height [in], `title_size` that of the title [pt].

    Raises
    ------
    AppError
        The file cannot be written.
    """
    with matplotlib.rc_context(MATPLOTLIB_STYLE):
        figure = Figure(figsize=size_in, layout="constrained")
        figure.suptitle(printable(title), fontweight="bold", color=TEXT_COLOR, fontsize=title_size)
        yield figure
        write_figure(figure, path, title)


def draw(
    history: MoodHistory, others: Sequence[EmotionTrack], robot: RobotTraces, labels: LabelSet
) -> Figure:
    """Return the figure; see `save_plot`."""
    figure = Figure(figsize=(WIDTH_PT / 72, HEIGHT_PT / 72))
    curves = _curves(history, others)
    first = curves[0].track
    left, right = TIME_PANELS_PT
    actions = panel(figure, left, ACTION_PT[0], right, ACTION_PT[1])
    start, end = float(first.times[0]), float(first.times[-1])
    actions.set_xlim(start, max(end, start + 1e-3))
    for edges, axis, name in ((VALENCE_PT, 0, "valence"), (AROUSAL_PT, 1, "arousal")):
        axes = panel(figure, left, edges[0], right, edges[1], sharex=actions)
        draw_bands(axes, first, labels, named=axis == 0)
        if not others:
            draw_robot(axes, axis, robot)
        for curve in reversed(curves):
            axes.plot(curve.track.times, curve.track.emotion[:, axis], clip_on=False, **curve.style)
        value_axis(axes, name)
        axes.tick_params(bottom=False, labelbottom=False)
        axes.spines[:].set_visible(False)
    draw_actions(actions, history)
    draw_plane(panel(figure, *PLANE_PT), labels, curves)
    _write_heading(figure, history, others)
    _write_legend(figure, curves, None if others else robot)
    _write_shares(figure, curves)
    return figure


def _curves(history: MoodHistory, others: Sequence[EmotionTrack]) -> list[EmotionCurve]:
    """Return the curves, the first one first: the recorded emotion, or other personalities'."""
    if not others:
        return [EmotionCurve(history.recorded, "felt, and asked of the robot", TEXT_COLOR, (), 1.8)]
    styles = itertools.cycle(CURVE_STYLES)
    curves = [
        EmotionCurve(track, printable(track.personality), *next(styles), 2.0) for track in others
    ]
    return [
        *curves,
        EmotionCurve(history.recorded, "as recorded", SECONDARY_COLOR, (1.5, 2.5), 1.2),
    ]


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
    write_line(figure, left, 42, f"Moods of {history.name}", fontsize=19, fontweight="bold")
    write_line(figure, left, 64, "   ·   ".join(parts), fontsize=11, color=SECONDARY_COLOR)


def _write_legend(
    figure: Figure, curves: Sequence[EmotionCurve], robot: RobotTraces | None
) -> None:
    """Name the lines in a row above the panels."""
    handles = [Line2D([], [], label=curve.name, **curve.style) for curve in curves]
    if robot is not None and len(robot.acknowledged.times):
        median_ms = 1e3 * float(np.median(robot.delays)) if len(robot.delays) else 0.0
        late = f" (median {median_ms:.0f} ms later)" if median_ms >= 0.5 else ""
        handles.append(Line2D([], [], label=f"acknowledged{late}", **ACKNOWLEDGED_STYLE))
    if robot:
        handles.append(
            Line2D([], [], label="observed on the robot", color=OBSERVED_COLOR, linewidth=5.0)
        )
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


def _write_shares(figure: Figure, curves: Sequence[EmotionCurve]) -> None:
    """Write how long each label lasted."""
    x, y = PLANE_PT[0], 504.0
    write_line(figure, x, y, "Time in each mood", fontweight="bold", fontsize=10.5)
    for curve in curves:
        if len(curves) > 1:
            y += 16
            write_line(figure, x, y, curve.name, color=SECONDARY_COLOR, fontsize=9)
        y += 13 if len(curves) > 1 else 18
        seconds: dict[str, float] = {}
        for label, start, end in runs(curve.track.labels, curve.track.times):
            seconds[label] = seconds.get(label, 0.0) + end - start
        longest = sorted(seconds.items(), key=lambda item: -item[1])[:MAX_SHARES]
        line = " · ".join(f"{label} {length:.1f} s" for label, length in longest)
        write_line(figure, x, y, line, fontsize=9)
