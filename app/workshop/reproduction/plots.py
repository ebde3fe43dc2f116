"""Plots of the page as SVG within it.

Needs matplotlib, the extra `[plots]`; only the page imports this module.
"""

import io
import re

import matplotlib
from matplotlib.figure import Figure

from cubeling.app.workshop.moods.colors import GRID_COLOR
from cubeling.app.workshop.moods.plot import FILE_METADATA
from cubeling.app.workshop.moods.plot_layout import MATPLOTLIB_STYLE
from cubeling.app.workshop.reproduction.result import DrawnFigure

STYLE = {
    **MATPLOTLIB_STYLE,
    "axes.grid": True,
    "grid.color": GRID_COLOR,
    "grid.linewidth": 0.7,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.titlesize": 10.5,
    "axes.labelsize": 10.0,
    "legend.frameon": False,
}

PICTURE_DPI = 110
"""Of what is not lines [1/in]."""


def inline_svg(plot: DrawnFigure) -> str:
    """Return a plot as an element of HTML: the same bytes for the same figures."""
    buffer = io.StringIO()
    with matplotlib.rc_context(STYLE):
        figure = Figure(figsize=plot.size_in, layout="constrained")
        plot.draw(figure)
        figure.savefig(buffer, format="svg", dpi=PICTURE_DPI, metadata=FILE_METADATA[".svg"])
    svg = buffer.getvalue()
    svg = svg[svg.index("<svg") :]
    # Several plots share a page: what nothing refers to needs no name, and the rest is a hash.
    used = set(re.findall(r"#([\w.-]+)", svg))
    return re.sub(r' id="([\w.-]+)"', lambda each: each[0] if each[1] in used else "", svg)
