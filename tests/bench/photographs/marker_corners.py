"""Corners of markers in a picture: as OpenCV finds them, and by lines along the sides."""

import cv2
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Picture = NDArray[np.uint8]

SIDE_SHARES = np.linspace(0.15, 0.85, 24)
"""Where a side is sampled: not at its ends, where the next side blurs into it."""

REACH = np.linspace(-3, 3, 49)
"""How far from a side its edge is searched, at right angles [px]."""

CELL_PX = 16
"""Size of a cell in the upright picture of a marker [px]."""

MAX_CORRECTION_PX = 3.0
"""A corner that lies further from OpenCV's is another edge's."""


def opencv_detector(dictionary: str, fine: bool = False) -> cv2.aruco.ArucoDetector:
    """OpenCV's detector with SUBPIX; `fine`: with a window that suits small markers."""
    parameters = cv2.aruco.DetectorParameters()
    parameters.cornerRefinementMethod = cv2.aruco.CORNER_REFINE_SUBPIX
    if fine:
        # The search window must not reach the next edge of a small marker.
        parameters.relativeCornerRefinmentWinSize = 0.3
    table = cv2.aruco.getPredefinedDictionary(getattr(cv2.aruco, dictionary))
    return cv2.aruco.ArucoDetector(table, parameters)


def opencv_corners(detector: cv2.aruco.ArucoDetector, picture: Picture) -> dict[int, Array]:
    """Corners of each marker that OpenCV detects, by id, (4, 2) [px]."""
    squares, ids = detector.detectMarkers(picture)[:2]
    numbers = [] if ids is None else [int(number) for number in np.ravel(ids)]
    return {
        number: np.reshape(square, (4, 2)).astype(np.float64)
        for number, square in zip(numbers, squares, strict=True)
    }


def line_corners(grey: Picture, square: Array) -> Array | None:
    """Corners where lines through a marker's four sides meet, (4, 2) → (4, 2) [px].

    A side has many times more pixels than a corner, so its line is known several times better.

    Returns
    -------
        None if a side lies elsewhere.
    """
    middle, lines = square.mean(axis=0), []
    for start, end in zip(square, np.roll(square, -1, axis=0), strict=True):
        along = end - start
        outward = np.array([along[1], -along[0]]) / np.linalg.norm(along)
        outward *= np.sign(outward @ (start - middle))
        points = start + SIDE_SHARES[:, None] * along
        places = points[:, None] + REACH[:, None] * outward
        profiles = cv2.remap(grey.astype(np.float32), places.astype(np.float32), None, 1)  # type: ignore[call-overload]
        # Outwards it grows bright: the edge is where it does so most.
        slopes = np.maximum(np.gradient(profiles, axis=1), 0) ** 2 + 1e-9
        edge = points + (slopes @ REACH / slopes.sum(axis=1))[:, None] * outward
        line = cv2.fitLine(edge.astype(np.float32), cv2.DIST_WELSCH, 0, 0.01, 0.01).ravel()
        lines.append(np.cross([*line[2:], 1], [*(line[2:] + line[:2]), 1]))
    corners = np.cross(lines, np.roll(lines, 1, axis=0))
    found = np.asarray(corners[:, :2] / corners[:, 2:], np.float64)
    return found if np.abs(found - square).max() < MAX_CORRECTION_PX else None


def cell_edges(grey: Picture, square: Array, cells: Array) -> list[tuple[float, float, float]]:
    """Where the edges between cells inside a marker lie, seen from its corners.

    Parameters
    ----------
    grey
        The picture.
    square
        Corners of the marker, (4, 2) [px].
    cells
        1 where a cell is white, (N, N), with the black border.

    Returns
    -------
        For each edge with two cells of one colour on each side: its place from the middle [cells],
        1 where white comes after black or else -1, and how far it is from its place [px].
    """
    size, found = len(cells) * CELL_PX, []
    upright = np.array([(0, 0), (size, 0), (size, size), (0, size)], np.float32) - np.float32(0.5)
    warp = cv2.getPerspectiveTransform(square.astype(np.float32), upright)
    patch = cv2.warpPerspective(grey, warp, (size, size)).astype(np.float64)
    middle, away = slice(CELL_PX // 3, CELL_PX - CELL_PX // 3), np.arange(-CELL_PX, CELL_PX) + 0.5
    sides = np.linalg.norm(square[[1, 2]] - square[[0, 1]], axis=1) / size
    for image, colours, scale in ((patch, cells, sides[0]), (patch.T, cells.T, sides[1])):
        for row, place in np.ndindex(len(cells) - 2, len(cells) - 3):
            four, place = colours[row + 1, place : place + 4], place + 2
            sign = four[2] - four[1]
            if sign == 0 or four[0] != four[1] or four[2] != four[3]:
                continue
            band = image[(row + 1) * CELL_PX : (row + 2) * CELL_PX][middle].mean(axis=0)
            profile = band[(place - 1) * CELL_PX : (place + 1) * CELL_PX]
            slopes = np.maximum(sign * np.gradient(profile), 0) ** 2 + 1e-9
            shift = scale * (slopes @ away) / slopes.sum()
            found.append((place - len(cells) / 2, float(sign), float(shift)))
    return found
