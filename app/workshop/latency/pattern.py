"""The pattern on the screen, and what a camera's picture shows of it."""

import cv2
import numpy as np
from numpy.typing import NDArray

from cubeling.app.ui.canvas import Canvas
from cubeling.app.ui.palette import HAPPY, INK, RULE, bgr
from cubeling.tracking import MarkerDetector, marker_cells

Picture = NDArray[np.uint8]
Array = NDArray[np.float64]

SIZE_PX = (1280, 720)
"""Width and height of the pattern [px]; it is shown as large as it fits."""

DICTIONARY = "DICT_4X4_50"
MARKER_CORNERS_PX: dict[int, tuple[int, int]] = {
    46: (50, 50),
    47: (1050, 50),
    48: (1050, 490),
    49: (50, 490),
}
"""Top left corner of each marker [px] by its id, which no bundled cube has."""

MARKER_SIZE_PX, QUIET_ZONE_PX = 180, 30
"""Size of a marker, and of the white around it [px]."""

MIN_MARKERS = 2
"""Markers that must be found to know where the fields are."""

FIELD_CORNERS_PX = ((330, 220), (650, 220))
"""Top left corners of the two fields, of which one is white and the other is black [px]."""

FIELD_SIZE_PX = 300
"""Size of a field [px]."""

BACKGROUND = bgr("#9a9a9a")
"""Grey, so that a camera's automatic exposure suits both fields."""

SEARCH_INTERVAL = 6
"""Pictures from one search for the markers to the next, once they are found."""

MIN_CONTRAST = 0.15
"""Fields whose difference is a smaller share of their sum are not told apart."""


def draw_pattern(left_is_white: bool, words: str, advice: str, progress: float) -> Picture:
    """Return the pattern with a sentence, an advice, and the share of the flips that are done.

    The two fields always have opposite colours, so the light on the camera stays the same, and the
    moment of a flip is the one in which both look alike, whatever the camera's tone curve.
    """
    canvas = Canvas(*SIZE_PX, 1.0)
    canvas.color[:] = BACKGROUND
    for marker_id, (x, y) in MARKER_CORNERS_PX.items():
        zone = QUIET_ZONE_PX
        canvas.color[y - zone : y + MARKER_SIZE_PX + zone, x - zone : x + MARKER_SIZE_PX + zone] = (
            255
        )
        cells = marker_cells(DICTIONARY, marker_id)
        cell = MARKER_SIZE_PX // len(cells)
        marker = np.kron(np.where(cells, 0, 255), np.ones((cell, cell)))
        canvas.color[y : y + MARKER_SIZE_PX, x : x + MARKER_SIZE_PX] = marker[..., None]
    for (x, y), white in zip(FIELD_CORNERS_PX, (left_is_white, not left_is_white), strict=True):
        canvas.color[y : y + FIELD_SIZE_PX, x : x + FIELD_SIZE_PX] = 255 if white else 0
    middle = SIZE_PX[0] / 2
    canvas.text(middle, 110, words, 40, INK, "middle")
    canvas.text(middle, 165, advice, 24, INK, "middle")
    canvas.bar(390, 620, 500, 14, RULE)
    canvas.bar(390, 620, max(14.0, 500 * progress), 14, HAPPY)
    canvas.text(middle, 672, "Esc ends", 20, INK, "middle")
    return canvas.color


class PatternReader:
    """Finds the pattern in a camera's pictures, and tells which field is white.

    The markers are searched for in every picture until they are found, then now and then. A camera
    that sees the screen in a mirror sees mirrored markers, so both kinds are tried.
    """

    def __init__(self) -> None:
        self._detector = MarkerDetector(DICTIONARY)
        self._mirrored = False
        self._picture_from_pattern: Array | None = None
        self._pictures_until_search = 0

    def read(self, image: Picture) -> float | None:
        """Return how much lighter the left field is than the right one, −1…1.

        0 is the middle of a flip; None where the pattern is not seen, or hardly.
        """
        grey = np.asarray(cv2.cvtColor(image, cv2.COLOR_BGR2GRAY), np.uint8)
        self._pictures_until_search -= 1
        if self._picture_from_pattern is None or self._pictures_until_search <= 0:
            self._picture_from_pattern = self._search(grey)
            self._pictures_until_search = SEARCH_INTERVAL
        if self._picture_from_pattern is None:
            return None
        places = cv2.perspectiveTransform(FIELD_POINTS, self._picture_from_pattern)
        columns, rows = np.rint(places).astype(int).transpose(2, 0, 1)
        height, width = grey.shape
        if min(columns.min(), rows.min()) < 0 or columns.max() >= width or rows.max() >= height:
            return None
        left, right = grey[rows, columns].mean(axis=1).tolist()
        return float(left - right) / max(float(left + right), 1.0)

    def _search(self, grey: Picture) -> Array | None:
        """Return the homography from the pattern to the picture, (3, 3)."""
        for mirrored in (self._mirrored, not self._mirrored):
            found = self._homography(np.ascontiguousarray(grey[:, ::-1]) if mirrored else grey)
            if found is not None:
                self._mirrored = mirrored
                flip = np.array([[-1.0, 0.0, grey.shape[1] - 1.0], [0, 1, 0], [0, 0, 1]])
                return flip @ found if mirrored else found
        return None

    def _homography(self, grey: Picture) -> Array | None:
        detected = self._detector.detect(grey)
        seen = {each.marker_id: each.corners for each in detected}
        known = [number for number in MARKER_CORNERS_PX if number in seen]
        if len(known) < MIN_MARKERS:
            return None
        square = MARKER_SIZE_PX * np.array([(0, 0), (1, 0), (1, 1), (0, 1)], float) - 0.5
        drawn = np.concatenate([square + MARKER_CORNERS_PX[number] for number in known])
        found, _ = cv2.findHomography(drawn, np.concatenate([seen[number] for number in known]))
        return None if found is None else np.asarray(found, float)


def _field_points() -> Array:
    """Return points inside both fields, away from their borders, (2, N, 2) [px]."""
    grid = np.linspace(0.2, 0.8, 12) * FIELD_SIZE_PX
    inside = np.stack(np.meshgrid(grid, grid), axis=-1).reshape(-1, 2)
    return np.stack([inside + corner for corner in FIELD_CORNERS_PX])


FIELD_POINTS = _field_points()
"""Where the fields are looked at in the pattern, (2, N, 2) [px]."""
