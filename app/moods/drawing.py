"""A drawing as a list of shapes, in points from the top left; `formats` writes it to a file."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]
Dashes = tuple[float, ...]


@dataclass(frozen=True)
class Area:
    """A filled polygon."""

    points: Array
    """Its corners, (n, 2)."""

    fill: str
    """Colour, "#rrggbb"."""


@dataclass(frozen=True)
class Line:
    """A line through points."""

    points: Array
    """Its points, (n, 2)."""

    colour: str
    """Colour, "#rrggbb"."""

    width: float
    """How thick."""

    dashes: Dashes = ()
    """Lengths of dash and gap; empty for a solid line."""


@dataclass(frozen=True)
class Disc:
    """A filled circle with an outline."""

    x: float
    """Its middle, to the right."""

    y: float
    """Its middle, down."""

    radius: float
    """Its radius."""

    fill: str
    """Colour, "#rrggbb"."""

    outline: str
    """Colour of a line about it, 1 wide."""


@dataclass(frozen=True)
class Text:
    """A line of words."""

    words: str
    """What it says."""

    x: float
    """Where `align` lies on the baseline, to the right."""

    y: float
    """The baseline, down."""

    size: float
    """Height of the letters."""

    colour: str
    """Colour, "#rrggbb"."""

    align: float = 0.0
    """Which share of the line lies left of `x`: 0, 0.5 or 1."""

    bold: bool = False
    """Whether it is bold."""

    upright: bool = False
    """Whether it runs upwards."""


Shape = Area | Line | Disc | Text


class Drawing:
    """Shapes on white paper, the later above the earlier."""

    def __init__(self, width: float, height: float, title: str) -> None:
        self.width, self.height = width, height
        self.title = printable(title)
        self.shapes: list[Shape] = []

    def area(self, points: ArrayLike, fill: str) -> None:
        """Fill a polygon."""
        self.shapes.append(Area(np.asarray(points, float), fill))

    def box(self, left: float, top: float, right: float, bottom: float, fill: str) -> None:
        """Fill a rectangle."""
        self.area([(left, top), (right, top), (right, bottom), (left, bottom)], fill)

    def line(self, points: ArrayLike, colour: str, width: float, dashes: Dashes = ()) -> None:
        """Draw a line through points; it is interrupted where a point is NaN."""
        whole = np.asarray(points, float).reshape(-1, 2)
        gaps = np.flatnonzero(np.isnan(whole).any(axis=1))
        for piece in np.split(whole, gaps):
            known = piece[~np.isnan(piece).any(axis=1)]
            if len(known) > 1:
                self.shapes.append(Line(thinned(known), colour, width, dashes))

    def disc(self, x: float, y: float, radius: float, fill: str, outline: str) -> None:
        """Draw a circle."""
        self.shapes.append(Disc(x, y, radius, fill, outline))

    def text(
        self,
        words: str,
        x: float,
        y: float,
        size: float,
        colour: str,
        align: float = 0.0,
        *,
        bold: bool = False,
        upright: bool = False,
    ) -> None:
        """Write words; what cannot be printed becomes "?"."""
        self.shapes.append(Text(printable(words), x, y, size, colour, align, bold, upright))


def thinned(points: Array, grain: float = 0.1) -> Array:
    """Return a line without the points that nobody would miss, so that an hour stays a small file.

    What is left passes within `grain` of every point (Ramer 1972; Douglas and Peucker 1973).
    """
    kept = np.zeros(len(points), bool)
    kept[[0, -1]] = True
    open_ = [(0, len(points) - 1)]
    while open_:
        first, last = open_.pop()
        way = points[last] - points[first]
        offsets = points[first + 1 : last] - points[first]
        if len(offsets) == 0:
            continue
        length = float(way @ way)
        along = np.clip(offsets @ way / length, 0.0, 1.0) if length > 0 else np.zeros(len(offsets))
        away = np.hypot(*(offsets - along[:, None] * way).T)
        worst = int(np.argmax(away))
        if away[worst] > grain:
            middle = first + 1 + worst
            kept[middle] = True
            open_ += [(first, middle), (middle, last)]
    return points[kept]


def printable(words: str) -> str:
    r"""Return words with "?" for what no file of ours may hold, as in an odd file name.

    >>> printable("a\x00b\udcffc")
    'a?b?c'
    """
    return "".join(letter if letter.isprintable() else "?" for letter in words)


def text_width(words: str, size: float) -> float:
    """Return about how wide words are: enough to decide whether they fit."""
    return 0.56 * size * len(words)
