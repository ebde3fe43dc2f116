"""The plot of a motion graph: distances with the jumps, and connectivity against the threshold.

Needs matplotlib, the extra `[plots]`; only `cubeling motions` imports this module.
"""

from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter

from cubeling.app.counted import quantity
from cubeling.app.workshop.moods.colors import (
    BORDER_COLOR,
    CURVE_STYLES,
    SECONDARY_COLOR,
)
from cubeling.app.workshop.moods.plot import titled_figure
from cubeling.app.workshop.moods.plot_layout import printable
from cubeling.characters.motion import (
    DISTANCES,
    WHOLE_BODY,
    MotionGraph,
    StoredGraph,
    connectivity_curves,
    distance_matrix,
    standard_graph,
)

SIZE_IN = (13.0, 6.4)
"""Width and height of the plot [in]."""

MAX_CELLS = 1600
"""Largest number of frames along a side of the matrix; more are thinned out."""

JUMP_COLOR = "#d55e00"


def save_plot(path: Path, stored: StoredGraph, title: str) -> None:
    """Write the plot of a motion graph; the suffix of the path says how.

    Raises
    ------
    AppError
        The file cannot be written.
    """
    with titled_figure(path, title, SIZE_IN) as figure:
        left, right = figure.subplots(1, 2, width_ratios=(1.0, 0.9))
        graph = standard_graph(stored)
        _draw_distances(figure, left, stored, graph)
        _draw_connectivity(right, stored)


def _draw_distances(figure: Figure, axes: Axes, stored: StoredGraph, graph: MotionGraph) -> None:
    """Draw the distances of all frames, and the jumps of the graph."""
    library = stored.library
    distances = np.sqrt(distance_matrix(DISTANCES[stored.distance](library)))
    stride = -(-len(library) // MAX_CELLS)
    count = len(library)
    image = axes.imshow(
        distances[::stride, ::stride],
        cmap="Greys_r",
        extent=(0, count, count, 0),
        interpolation="nearest",
        vmax=float(np.quantile(distances, 0.95)),
    )
    edges = graph.edges
    jumps = library.successors[edges.sources] != edges.targets
    axes.plot(
        edges.targets[jumps],
        edges.sources[jumps],
        linestyle="none",
        marker=".",
        markersize=2.2,
        color=JUMP_COLOR,
        label=quantity(graph.jumps, "jump"),
    )
    for start in library.starts[1:-1].tolist():
        axes.axhline(start, color=BORDER_COLOR, linewidth=0.5)
        axes.axvline(start, color=BORDER_COLOR, linewidth=0.5)
    middles = (library.starts[:-1] + library.starts[1:]) / 2
    names = [printable(name) for name in library.names]
    axes.set_yticks(middles, names, fontsize=7)
    axes.set_xticks(middles, names, rotation=90, fontsize=7)
    axes.tick_params(length=0)
    axes.set_title("from a frame (down) to a frame (across)", color=SECONDARY_COLOR, fontsize=10)
    axes.legend(loc="upper right", markerscale=4, framealpha=0.9)
    figure.colorbar(image, ax=axes, shrink=0.8, label="root of the distance")


def _draw_connectivity(axes: Axes, stored: StoredGraph) -> None:
    """Draw the share of connected frames against the threshold."""
    curves = connectivity_curves(stored)
    for (name, (thresholds, shares)), (color, dashes) in zip(
        curves.items(), CURVE_STYLES, strict=False
    ):
        label = "whole body" if name == WHOLE_BODY else name
        style = (0, dashes or None)
        axes.step(thresholds, shares, where="post", color=color, linestyle=style, label=label)
        axes.axvline(stored.thresholds[name], color=color, linewidth=0.6, linestyle=style)
    plain_log_axis(axes)
    axes.set_ylim(0.0, 1.02)
    axes.set_xlabel("threshold")
    axes.set_ylabel("frames in the largest connected part")
    axes.set_title("vertical: the thresholds in use", color=SECONDARY_COLOR, fontsize=10)
    axes.grid(True, color="#dcdfe6", linewidth=0.7)
    axes.legend(loc="lower right")


def plain_log_axis(axes: Axes) -> None:
    """Let the x axis be logarithmic, with numbers as people write them."""
    axes.set_xscale("log")
    axes.xaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    axes.xaxis.set_minor_formatter(FuncFormatter(lambda value, _: ""))
