"""The layout and the style of the mood plot, and what its panels have in common."""

from dataclasses import dataclass
from functools import lru_cache
from typing import Any

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.font_manager import FontProperties
from matplotlib.textpath import TextPath
from matplotlib.ticker import FixedLocator, FuncFormatter

from cubeling.app.workshop.moods.colors import BORDER_COLOR, GRID_COLOR, SECONDARY_COLOR, TEXT_COLOR
from cubeling.app.workshop.moods.history import EmotionTrack

WIDTH_PT, HEIGHT_PT = 1120.0, 668.0
"""Size of the plot. Lengths count from its top left corner."""

TIME_PANELS_PT = (70.0, 710.0)
"""Left and right edge of the panels over time."""

VALENCE_PT, AROUSAL_PT, ACTION_PT = (112.0, 306.0), (334.0, 474.0), (500.0, 574.0)
"""Top and bottom edge of each of them."""

PLANE_PT = (790.0, 112.0, 1090.0, 412.0)
"""Left, top, right and bottom edge of the plane."""

MATPLOTLIB_STYLE: dict[Any, Any] = {
    "font.family": "sans-serif",
    "font.sans-serif": ["DejaVu Sans"],  # matplotlib brings it: the same plot on every machine
    "font.size": 10.0,
    "text.color": TEXT_COLOR,
    "text.parse_math": False,  # a file name may contain "$"
    "axes.edgecolor": BORDER_COLOR,
    "axes.labelcolor": TEXT_COLOR,
    "axes.labelsize": 11.5,
    "axes.linewidth": 0.8,
    "axes.axisbelow": True,
    "xtick.color": TEXT_COLOR,
    "ytick.color": TEXT_COLOR,
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


@dataclass(frozen=True)
class EmotionCurve:
    """One of the emotions that are compared in a plot."""

    track: EmotionTrack

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


def panel(
    figure: Figure, left: float, top: float, right: float, bottom: float, **options: Any
) -> Axes:
    """Return axes between four edges [pt from the top left corner]."""
    width, height = (right - left) / WIDTH_PT, (bottom - top) / HEIGHT_PT
    return figure.add_axes((left / WIDTH_PT, 1 - bottom / HEIGHT_PT, width, height), **options)


def value_axis(axes: Axes, name: str, *, horizontal: bool = False) -> None:
    """Let an axis run from −1 to 1, with a grid."""
    axis = axes.xaxis if horizontal else axes.yaxis
    (axes.set_xlim if horizontal else axes.set_ylim)(-1.0, 1.0)
    axis.set_major_locator(FixedLocator([-1.0, -0.5, 0.0, 0.5, 1.0]))
    axis.set_major_formatter(FuncFormatter(lambda value, _: _with_sign(value)))
    axis.set_label_text(f"{name} [1]")
    if not horizontal:
        axis.set_label_coords(-46 / width_pt(axes), 0.5)
    axis.grid(True, color=GRID_COLOR, linewidth=0.7)
    (axes.axvline if horizontal else axes.axhline)(
        0.0, color=SECONDARY_COLOR, linewidth=0.7, zorder=1
    )


def _with_sign(value: float) -> str:
    """Return a number with its sign, and a real minus.

    >>> [_with_sign(value) for value in (-0.5, 0.0, 1.0)]
    ['−0.5', '0', '+1']
    """
    return f"{value:+g}".replace("-", "−").replace("+0.5", "0.5") if value else "0"


def write_line(figure: Figure, x: float, y: float, words: str, **style: Any) -> None:
    """Write a line whose baseline starts at a point [pt from the top left corner]."""
    figure.text(x / WIDTH_PT, 1 - y / HEIGHT_PT, printable(words), va="baseline", **style)


def fits(axes: Axes, word: str, start: float, end: float) -> bool:
    """Return whether a bold word fits between two times of a panel."""
    first, last = axes.get_xlim()
    return _word_width_pt(word) + 4 < (end - start) / (last - first) * width_pt(axes)


def width_pt(axes: Axes) -> float:
    """Return the width of axes [pt]."""
    return float(axes.get_position().width * WIDTH_PT)


@lru_cache(maxsize=256)
def _word_width_pt(word: str) -> float:
    path = TextPath(
        (0, 0), word, size=MATPLOTLIB_STYLE["font.size"], prop=FontProperties(weight="bold")
    )
    return float(path.get_extents().width)


def printable(words: str) -> str:
    r"""Return words with "?" for every character that cannot be printed, as in an odd file name.

    >>> printable("a\x00b\udcffc")
    'a?b?c'
    """
    return "".join(letter if letter.isprintable() else "?" for letter in words)
