"""The cells of a marker, and its black shape as outlines."""

from functools import cache

import cv2
import numpy as np

from cubeling.tracking.cube.model import CubeModel, aruco_dictionary
from cubeling.tracking.geometry.arrays import Array, Flags

GRID_STEPS = ((1, 0), (0, 1), (-1, 0), (0, -1))
"""Steps along cell borders, clockwise with y down."""


def marker_cells(dictionary: str, marker_id: int) -> Flags:
    """Return which cells of a marker are black, with its border, (rows, columns)."""
    pattern = aruco_dictionary(dictionary)
    picture = cv2.aruco.generateImageMarker(pattern, marker_id, pattern.markerSize + 2)
    return np.asarray(picture) < 128


@cache
def turned_markers(dictionary: str) -> Flags:
    """Return which cells of each marker of a dictionary are black, turned four ways.

    (N, 4, cells), with the cells of `marker_cells` in one row, the marker as it is first.
    """
    count = len(aruco_dictionary(dictionary).bytesList)
    cells = [marker_cells(dictionary, marker_id) for marker_id in range(count)]
    turned = [[np.rot90(each, turns).ravel() for turns in range(4)] for each in cells]
    return np.asarray(turned, np.bool_)


def cell_size(cube: CubeModel) -> float:
    """Edge of one cell of a cube's markers [m]."""
    return cube.marker_size / len(marker_cells(cube.dictionary, cube.faces[0].marker_id))


def black_texels(cube: CubeModel, cells: Flags, side: int, width: float) -> Flags:
    """Return which texels of a square around a marker are black where it has these cells.

    `side` is how many there are along each side of the square, and `width` how long it is [m].
    """
    texel = (np.arange(side) + 0.5) / side * width - width / 2
    cell = (texel + cube.marker_size / 2) / cube.marker_size * len(cells)
    inside = (cell >= 0) & (cell < len(cells))
    index = np.clip(cell.astype(int), 0, len(cells) - 1)
    return np.asarray(cells[index][:, index] & inside[:, None] & inside)


def marker_loops(dictionary: str, marker_id: int) -> list[Array]:
    """Outline the black of a marker: one path, as adjacent squares would show seams.

    The loops, (N, 2) in the unit square, x right and y down, go clockwise around black and
    counter-clockwise around white inside it, so the nonzero and the even-odd rule agree.
    """
    cells = marker_cells(dictionary, marker_id)
    outgoing = _borders(cells)
    loops = []
    while outgoing:
        start = point = min(outgoing)  # a corner of its loop: nothing is left of it
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


def _borders(cells: Flags) -> dict[tuple[int, int], list[tuple[int, int]]]:
    """List the steps along black cells from each grid point, with black on the right."""
    around = np.pad(cells, 1)
    steps: dict[tuple[int, int], list[tuple[int, int]]] = {}
    for row, column in np.argwhere(cells).tolist():
        x, y = column, row
        for dx, dy in GRID_STEPS:
            if not around[row + 1 - dx, column + 1 + dy]:  # white on the left
                steps.setdefault((x, y), []).append((dx, dy))
            x, y = x + dx, y + dy
    return steps


def _next_step(choices: list[tuple[int, int]], last: tuple[int, int]) -> tuple[int, int]:
    """Turn right first: where two black cells meet only at a corner, stay with the same cell."""
    right = GRID_STEPS[(GRID_STEPS.index(last) + 1) % 4]
    return right if right in choices else choices[0]
