"""The black shape of a marker as outlines, for a picture of any size."""

import cv2
import numpy as np
from numpy.typing import NDArray

from tracking.cube.model import aruco_dictionary

Loop = NDArray[np.float64]

TURNS = ((1, 0), (0, 1), (-1, 0), (0, -1))
"""Steps along cell borders, clockwise with y down."""


def marker_cells(dictionary: str, marker_id: int) -> NDArray[np.bool_]:
    """Return which cells of a marker are black, its border included, (cells, cells), rows first."""
    pattern = aruco_dictionary(dictionary)
    picture = cv2.aruco.generateImageMarker(pattern, marker_id, pattern.markerSize + 2)
    return np.asarray(picture) < 128


def marker_loops(dictionary: str, marker_id: int) -> list[Loop]:
    """Outline the black of a marker.

    One filled path has no seams between its cells, as squares side by side have.

    Returns
    -------
    Loops (N, 2) in the unit square, x right and y down, first corner anywhere: clockwise around
    black, the other way around the white inside it, so the nonzero and the even-odd rule agree.
    """
    cells = marker_cells(dictionary, marker_id)
    outgoing = _borders(cells)
    loops = []
    while outgoing:
        start = point = min(outgoing)  # a corner of its loop, as nothing lies left of it
        step = last = outgoing[start][0]
        loop: list[tuple[int, int]] = []
        while True:
            outgoing[point].remove(step)
            if not outgoing[point]:
                del outgoing[point]
            if not loop or step != last:
                loop.append(point)
            last = step
            point = (point[0] + step[0], point[1] + step[1])
            if point == start:
                break
            step = _next_step(outgoing[point], last)
        loops.append(np.array(loop, float) / len(cells))
    return loops


def _borders(cells: NDArray[np.bool_]) -> dict[tuple[int, int], list[tuple[int, int]]]:
    """List the steps along black cells from each grid point, black on the right hand."""
    around = np.pad(cells, 1)
    steps: dict[tuple[int, int], list[tuple[int, int]]] = {}
    for row, column in np.argwhere(cells):
        corner = np.array(
            [(column, row), (column + 1, row), (column + 1, row + 1), (column, row + 1)]
        )
        beside = (
            (row, column + 1),
            (row + 1, column + 2),
            (row + 2, column + 1),
            (row + 1, column),
        )
        for (x, y), step, neighbour in zip(corner, TURNS, beside, strict=True):
            if not around[neighbour]:
                steps.setdefault((int(x), int(y)), []).append(step)
    return steps


def _next_step(choices: list[tuple[int, int]], last: tuple[int, int]) -> tuple[int, int]:
    """Where two black cells meet at a corner only, stay with the cell at hand: turn right first."""
    right = TURNS[(TURNS.index(last) + 1) % 4]
    return right if right in choices else choices[0]
