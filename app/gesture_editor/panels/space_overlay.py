"""The gesture space over the picture of a character: sectors of a hand, and the one it is in."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from itertools import pairwise

import cv2
import numpy as np
from numpy.typing import NDArray

from cubeling.app.gesture_editor.panels.widgets import ACCENT
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

LINE_OPACITY, CELL_OPACITY = 0.4, 0.5
"""How much the borders of sectors, and the sector of the hand, cover."""


@dataclass(frozen=True, eq=False)
class ShownSpace:
    """The gesture space of a character in the picture of a camera."""

    space: GestureSpace
    """The space, in the character frame."""

    table_from_character: Array
    """Where the character stands, (4, 4)."""

    camera: PortraitCamera
    """Who sees it."""

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

    def draw(self, picture: NDArray[np.uint8], place: Place | None) -> None:
        """Draw the sectors at the distance of a place over a picture, in place."""
        depth = CENTRES_Z_CM["ZMiddle" if place is None else place.z]
        columns, rows = _edges(CENTRES_X_CM.values()), _edges(CENTRES_Y_CM.values())
        lines = [
            *(((x, rows[0], depth), (x, rows[-1], depth)) for x in columns),
            *(((columns[0], y, depth), (columns[-1], y, depth)) for y in rows),
        ]
        drawn = picture.copy()
        for line in lines:
            cv2.polylines(drawn, [_fixed(self.pixels(line))], False, ACCENT, 1, cv2.LINE_AA, 4)
        picture[:] = cv2.addWeighted(picture, 1 - LINE_OPACITY, drawn, LINE_OPACITY, 0.0)
        if place is None or place.contact:
            return
        across, up = list(CENTRES_X_CM).index(place.x), list(CENTRES_Y_CM).index(place.y)
        corners = [
            (columns[across + i], rows[up + j], depth) for i, j in ((0, 0), (1, 0), (1, 1), (0, 1))
        ]
        drawn = picture.copy()
        cv2.fillConvexPoly(drawn, _fixed(self.pixels(corners)), ACCENT, cv2.LINE_AA, 4)
        picture[:] = cv2.addWeighted(picture, 1 - CELL_OPACITY, drawn, CELL_OPACITY, 0.0)


def _edges(centres: Iterable[float]) -> list[float]:
    """Return the borders of cells: midway between their centres, and as far outside.

    >>> _edges([45.0, 30.0, 15.0, -15.0])
    [52.5, 37.5, 22.5, 0.0, -30.0]
    """
    values = list(centres)
    between = [(a + b) / 2 for a, b in pairwise(values)]
    return [2 * values[0] - between[0], *between, 2 * values[-1] - between[-1]]


def _fixed(pixels: Array) -> NDArray[np.int32]:
    return np.asarray(np.round(pixels * 16.0), np.int32)
