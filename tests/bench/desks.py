"""Desks unlike the wooden one of the synthetic pictures, seen from above: drawn, or photographs."""

from collections.abc import Callable

import cv2
import numpy as np

from cubeling.tracking.geometry.arrays import Floats
from cubeling.tracking.synthetic.desk import DESK_TEXELS, Colour

PHOTOGRAPH_M, PHOTOGRAPH_AT = (0.9, 0.65), (850, 900)
"""Sides of a photograph that lies under the cube [m], and its first column and row [texels]."""

PRINT_LINES_MM, COLUMN_MM, WORDS_MM = 9, 260, (6, 26)
"""From line to line of a printed desk, from column to column, and how long words are [mm]."""


def painted(colour: Colour, unevenness: float) -> Callable[[np.random.Generator], Floats]:
    """Return what draws a desk of one colour, brighter and darker by a standard deviation."""

    def draw(random: np.random.Generator) -> Floats:
        return _grainy(colour, unevenness, 40, random)

    return draw


def checked(random: np.random.Generator) -> Floats:
    """Draw a tablecloth of red and white threads, woven to squares of 30 mm."""
    stripes = np.arange(DESK_TEXELS) // 30 % 2
    red = (stripes[:, None] + stripes)[..., None] * np.float32(0.5)
    return np.asarray(235 - red * np.array((170, 170, 45), np.float32), np.float32)


def carpet(random: np.random.Generator) -> Floats:
    """Draw a brown carpet with strands of 2 mm."""
    return _grainy((70.0, 80.0, 110.0), 22.0, 2, random)


def printed(random: np.random.Generator) -> Floats:
    """Draw a newspaper that covers the whole desk."""
    desk = np.full((DESK_TEXELS, DESK_TEXELS, 3), 225, np.float32)
    for top in range(0, DESK_TEXELS, PRINT_LINES_MM):
        for column in range(0, DESK_TEXELS, COLUMN_MM):
            left, end = column + 15, column + COLUMN_MM - 30
            while left < end:
                right = left + int(random.integers(*WORDS_MM))
                desk[top : top + 4, left : min(right, end)] = 60
                left = right + 5
    return desk


def _grainy(colour: Colour, deviation: float, grain_mm: int, random: np.random.Generator) -> Floats:
    cells = DESK_TEXELS // grain_mm
    grain = random.standard_normal((cells, cells)).astype(np.float32)
    large = cv2.resize(grain, (DESK_TEXELS, DESK_TEXELS), interpolation=cv2.INTER_LINEAR)
    brightness = 1 + np.asarray(large)[..., None] * np.float32(deviation / np.mean(colour))
    return np.asarray((np.array(colour, np.float32) * brightness).clip(5, 250), np.float32)


DESKS: dict[str, Callable[[np.random.Generator], Floats]] = {
    "white": painted((225.0, 228.0, 230.0), 0.0),
    "dark": painted((50.0, 48.0, 46.0), 3.0),
    "skin": painted((150.0, 185.0, 225.0), 4.0),
    "red": painted((60.0, 60.0, 170.0), 4.0),
    "checked": checked,
    "carpet": carpet,
    "printed": printed,
}
"""What draws each desk, from a generator of random numbers."""


def desk_picture(name: str, random: np.random.Generator) -> Floats:
    """Return a desk from above, (DESK_TEXELS, DESK_TEXELS, 3) BGR.

    `name` is one of `DESKS`, or the path of a photograph that lies under the cube, on a desk of its
    mean colour. A `ValueError` says that it is neither.
    """
    if name in DESKS:
        return DESKS[name](random)
    photograph = cv2.imread(name)
    if photograph is None:
        raise ValueError(f"{name} is neither a picture nor one of {', '.join(DESKS)}")
    desk = np.empty((DESK_TEXELS, DESK_TEXELS, 3), np.float32)
    desk[:] = photograph.mean(axis=(0, 1))
    width, height = (round(1000 * side) for side in PHOTOGRAPH_M)
    left, top = PHOTOGRAPH_AT
    shrunk = cv2.resize(photograph, (width, height), interpolation=cv2.INTER_AREA)
    desk[top : top + height, left : left + width] = shrunk
    return desk
