"""The gesture space over the picture of a character: sectors of a hand, and the one it is in."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from cubeling.characters.behaviour import (
    CENTRES_X_CM,
    CENTRES_Y_CM,
    CENTRES_Z_CM,
    CHEST_CM,
    REFERENCE_ARM_M,
    GestureSpace,
    Place,
)
from cubeling.characters.rendering import PortraitCamera

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class ShownSpace:
    """The gesture space of a character in the picture of a camera."""

    space: GestureSpace
    """The space, in the character frame."""

    table_from_character: Array
    """Where the character stands, (4, 4)."""

    camera: PortraitCamera

    left: bool
    """Whether the space is that of the left hand."""

    def pixels(self, centimetres: Sequence[tuple[float, float, float]]) -> Array:
        """Return where points outward, up and forward [cm] are in the picture, (n, 2) [px]."""
        own = (np.array(centimetres) - [0.0, CHEST_CM, 0.0]) / 100.0
        own *= self.space.arm / REFERENCE_ARM_M
        points = self.space.chest + self.space.vector(own, self.left)
        seen = self.camera.camera_from_table @ self.table_from_character
        camera = points @ seen[:3, :3].T + seen[:3, 3]
        image = camera @ self.camera.matrix.T
        pixels: Array = image[:, :2] / image[:, 2:]
        return pixels

    def borders(self, depth: float) -> list[Array]:
        """Return the borders of the sectors at a distance from the chest [cm], each (2, 2) [px]."""
        lines = [
            *(((x, _ROWS[0], depth), (x, _ROWS[-1], depth)) for x in _COLUMNS),
            *(((_COLUMNS[0], y, depth), (_COLUMNS[-1], y, depth)) for y in _ROWS),
        ]
        return [self.pixels(line) for line in lines]

    def sector(self, place: Place) -> Array:
        """Return the corners of the sector of a place, (4, 2) [px]."""
        across, up = list(CENTRES_X_CM).index(place.x), list(CENTRES_Y_CM).index(place.y)
        depth = CENTRES_Z_CM[place.z]
        corners = ((0, 0), (1, 0), (1, 1), (0, 1))
        return self.pixels([(_COLUMNS[across + i], _ROWS[up + j], depth) for i, j in corners])


def _edges(centres: Iterable[float]) -> list[float]:
    """Return the borders of cells: midway between their centres, and as far outside.

    >>> _edges([45.0, 30.0, 15.0, -15.0])
    [52.5, 37.5, 22.5, 0.0, -30.0]
    """
    values = list(centres)
    between = [(a + b) / 2 for a, b in pairwise(values)]
    return [2 * values[0] - between[0], *between, 2 * values[-1] - between[-1]]


_COLUMNS, _ROWS = _edges(CENTRES_X_CM.values()), _edges(CENTRES_Y_CM.values())
"""Borders of the sectors outward and up [cm]."""
