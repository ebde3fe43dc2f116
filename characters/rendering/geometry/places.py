"""Which vertices are at one place, and which places are connected."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from cubeling.characters.rendering.geometry.quadrics import Indices

CELL_SHARE = 1e-5
"""Side of the cells in which all vertices are at one place, as a share of the mesh's largest side.
Exporters write the two sides of a seam with differences of up to so much."""

CELL_SHIFTS = (0.0, 0.25, 0.5, 0.75)
"""Where the cells of four grids begin, in cells, along each axis. Of the four, a border of at most
one lies between two positions that are less than a quarter of a cell apart; as there are three
axes, at least one grid has both in one cell."""


def places_of(positions: NDArray[np.float32]) -> Indices:
    """Return the number of the place of each vertex, (vertices,).

    Vertices less than `CELL_SHARE` / 4 of the largest side apart are at one place, wherever the
    borders of cells lie: what a rotation rounds differently is still one point.

    >>> places_of(np.array([[0, 0, 0], [1, 0, 0], [1, 1e-19, 0], [0, 0, 0]], np.float32)).tolist()
    [0, 1, 1, 0]
    """
    points, place = np.unique(positions, axis=0, return_inverse=True)
    cells = (points - points.min(axis=0)).astype(float)
    cells /= CELL_SHARE * max(float(cells.max()), 1e-30)
    neighbours = []
    for shift in CELL_SHIFTS:
        keys = np.floor(cells + shift).astype(np.int64) @ np.array([1 << 40, 1 << 20, 1])
        order = np.argsort(keys, kind="stable")
        same = np.diff(keys[order]) == 0
        neighbours.append(np.stack([order[:-1][same], order[1:][same]], axis=1))
    lowest = connect(np.concatenate(neighbours), len(points))
    return np.unique(lowest, return_inverse=True)[1][place.reshape(-1)].astype(np.intp)


def are_whole(triangles: NDArray[np.integer[Any]]) -> NDArray[np.bool_]:
    """Return which triangles (n, 3) have three different corners.

    >>> are_whole(np.array([[0, 1, 2], [0, 1, 0]])).tolist()
    [True, False]
    """
    return np.asarray((triangles != np.roll(triangles, 1, axis=1)).all(axis=1))


def connect(together: Indices, count: int) -> Indices:
    """Return the lowest of the places to which each one is connected, (count,).

    The places in a row of `together`, (n, k), as the corners of a triangle, are connected.
    """
    lowest = np.arange(count)
    while True:
        least = lowest[together].min(axis=1)
        following = lowest.copy()
        for column in together.T:
            np.minimum.at(following, lowest[column], least)
        following = following[following]
        if (following == lowest).all():
            return lowest
        lowest = following
