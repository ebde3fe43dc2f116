"""The plot of which clip each part of the body plays: figures 3.8 to 3.10 of the thesis.

Needs matplotlib, the extra `[plots]`; only `cubeling motions transition` and the page of printed
tables import this module.
"""

from collections.abc import Mapping, Sequence
from itertools import groupby
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Patch
from numpy.typing import NDArray

from cubeling.app.workshop.moods.colors import GRID_COLOR, SECONDARY_COLOR, TEXT_COLOR
from cubeling.app.workshop.moods.plot import titled_figure
from cubeling.app.workshop.moods.plot_layout import printable
from cubeling.app.workshop.motion_graphs.transition import FoundTransition
from cubeling.characters.motion import MotionLibrary

CONTEXT_FRAMES = 6
"""Frames of the clips that are shown before the request and after the last arrival."""

WIDTH_IN, ROW_IN, PANEL_IN, EDGE_IN = 9.0, 0.3, 0.45, 0.9
"""Width of the figure, height of a row, and of what stands around those of a panel and of all."""

LEGEND_COLUMNS, LEGEND_ROW_IN = 4, 0.22
"""Names side by side in the legend, and height of a line of them."""

BARS_IN, LETTER_IN = 7.8, 0.075
"""Width of the bars and of a letter on them; a name that does not fit is in the legend alone."""

CLIP_COLORS = ("#8fbbdb", "#eba06d", "#8ccdb3", "#d3a5c6", "#e8dc8a", "#b9bfcb")
"""Colours of the clips in the order in which they play, pale enough to write on: those of Okabe and
Ito 2008, which colour-blind people can tell apart. More clips have them again, with a pattern."""

CLIP_PATTERNS = ("", "///", "---", "xxx")
"""Patterns of the first six clips, the next six …"""


def save_timeline(
    path: Path, library: MotionLibrary, found: Sequence[FoundTransition], title: str
) -> None:
    """Write the plot of transitions from one frame; the suffix of the path says how.

    Raises
    ------
    AppError
        The file cannot be written.
    """
    with titled_figure(path, title, timeline_size_in(library, found)) as figure:
        draw_timeline(figure, library, found)


def timeline_size_in(
    library: MotionLibrary, found: Sequence[FoundTransition]
) -> tuple[float, float]:
    """Return the width and the height that the plot of transitions needs [in]."""
    shown = {clip for rows in _playing(library, found) for clip in rows.ravel().tolist()}
    edge = EDGE_IN + LEGEND_ROW_IN * -(-len(shown) // LEGEND_COLUMNS)
    return WIDTH_IN, sum(_heights(found)) + edge


def draw_timeline(figure: Figure, library: MotionLibrary, found: Sequence[FoundTransition]) -> None:
    """Draw which clip each part plays, in an empty figure."""
    playing = _playing(library, found)
    order = list(dict.fromkeys(np.concatenate([rows.T.ravel() for rows in playing]).tolist()))
    styles = {clip: _style(place) for place, clip in enumerate(order)}
    grid = figure.subplots(len(found), 1, sharex=True, height_ratios=_heights(found), squeeze=False)
    for axes, each, rows in zip(grid[:, 0], found, playing, strict=True):
        _draw(axes, library, each, rows, styles)
    grid[-1, 0].set_xlabel(f"frames since the request, at {library.rate:g} Hz")
    last = max(each.transition.duration for each in found)
    grid[-1, 0].set_xlim(-CONTEXT_FRAMES, last + CONTEXT_FRAMES)
    patches = [
        Patch(label=printable(library.names[clip]), **style) for clip, style in styles.items()
    ]
    figure.legend(handles=patches, loc="outside lower center", ncols=LEGEND_COLUMNS, frameon=False)


def _playing(library: MotionLibrary, found: Sequence[FoundTransition]) -> list[NDArray[np.intp]]:
    """Return the clips of each, (parts, times), all over the time of the longest."""
    last = max(each.transition.duration for each in found)
    count = last + 2 * CONTEXT_FRAMES
    return [each.clips(library, CONTEXT_FRAMES + last)[:, last : last + count] for each in found]


def _heights(found: Sequence[FoundTransition]) -> list[float]:
    return [PANEL_IN + ROW_IN * len(each.parts) for each in found]


def _style(place: int) -> dict[str, Any]:
    """Return how a clip is drawn, by its place among those that are shown."""
    again, color = divmod(place, len(CLIP_COLORS))
    hatch = CLIP_PATTERNS[min(again, len(CLIP_PATTERNS) - 1)]
    return {"facecolor": CLIP_COLORS[color], "hatch": hatch, "edgecolor": "#ffffff", "linewidth": 0}


def _draw(
    axes: Axes,
    library: MotionLibrary,
    each: FoundTransition,
    rows: NDArray[np.intp],
    styles: Mapping[int, dict[str, Any]],
) -> None:
    """Draw a bar for each part: the clips that it plays, (parts, times)."""
    transition = each.transition
    for row, (clips, move) in enumerate(zip(rows, transition.moves, strict=True)):
        start = -CONTEXT_FRAMES
        for clip, run in groupby(clips.tolist()):
            length = len([*run])
            axes.broken_barh([(start, length)], (row - 0.42, 0.72), **styles[clip])
            name = printable(library.names[clip])
            if len(name) * LETTER_IN < length / rows.shape[1] * BARS_IN:
                axes.text(start + length / 2, row, name, ha="center", va="center", fontsize=8.5)
            start += length
        # On its way the part is scaled in time, and may play any clip.
        way = move.departure, move.arrival
        axes.plot(way, [row + 0.38] * 2, color=TEXT_COLOR, linewidth=1.2, marker="|", markersize=6)
    for time in (0, transition.response, transition.duration):
        style = "-" if time == 0 else (0, (3, 2))
        axes.axvline(time, color=SECONDARY_COLOR, linewidth=0.9, linestyle=style)
    axes.set_yticks(range(len(each.parts)), each.parts)
    axes.set_ylim(len(each.parts) - 0.5, -0.5)
    axes.set_title(each.summary, loc="left", color=SECONDARY_COLOR, fontsize=9.5)
    axes.grid(True, axis="x", color=GRID_COLOR, linewidth=0.6)
    axes.spines[:].set_visible(False)
    axes.tick_params(axis="x", length=0)
