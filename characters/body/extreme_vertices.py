"""The extreme vertices of a character: they bound it in any pose, without all the others."""

import numpy as np
from numpy.typing import NDArray


def _directions(side: int) -> NDArray[np.float32]:
    """Return the directions (n, 3) of a grid on the surface of a cube, `side` points per edge.

    >>> _directions(3).shape, _directions(5).shape
    ((26, 3), (98, 3))
    """
    grid = np.stack(np.meshgrid(*[np.linspace(-1.0, 1.0, side)] * 3), axis=-1).reshape(-1, 3)
    surface = grid[np.abs(grid).max(axis=1) == 1.0]
    return np.asarray(surface / np.linalg.norm(surface, axis=1, keepdims=True), np.float32)


DIRECTIONS, FINE_DIRECTIONS = _directions(3), _directions(5)
"""Directions in which extreme vertices are searched: for most joints, and for those that move a
large part of the character. A sphere exceeds its extreme vertices by up to 11 or 5 % of its radius.
"""

MIN_LARGE_PART = 0.3
"""Share of the character's size from which on a joint's vertices are a large part."""

BLOCK_POINTS = 256
"""Points that are skinned by one matrix product."""


def extreme_vertices(positions: NDArray[np.float32], owner: NDArray[np.uint32]) -> NDArray[np.intp]:
    """Return the indices of the vertices that are the furthest of their owner in some direction.

    `positions` are (vertices, 3); `owner` (vertices,) is that of each vertex, such as a joint.
    """
    order = np.argsort(owner, kind="stable")
    borders = np.flatnonzero(np.diff(owner[order])) + 1
    columns = np.ascontiguousarray(positions[order].T)  # one row for each coordinate, for speed
    large = MIN_LARGE_PART * np.ptp(columns, axis=1).max()
    found = []
    for indices, part in zip(
        np.split(order, borders), np.split(columns, borders, axis=1), strict=True
    ):
        directions = FINE_DIRECTIONS if np.ptp(part, axis=1).max() > large else DIRECTIONS
        # No matrix product: its threads wait for each other on a busy machine.
        found.append(indices[np.einsum("dk,kv->dv", directions, part).argmax(axis=1)])
    return np.unique(np.concatenate(found))


class SkinnedPoints:
    """Some points of a character, skinned by one matrix product.

    `positions` are (n, 3); `joints` (n, k) are rows of the palette of `rows` matrices that move
    them, with `weights` (n, k).
    """

    def __init__(
        self,
        positions: NDArray[np.float32],
        joints: NDArray[np.uint32],
        weights: NDArray[np.float32],
        rows: int,
    ) -> None:
        self._count = len(positions)
        blocks = -(-self._count // BLOCK_POINTS)
        by_row = np.zeros((rows, blocks * BLOCK_POINTS), np.float32)
        np.add.at(by_row, (joints, np.arange(self._count)[:, None]), weights)
        by_block = by_row.reshape(rows, blocks, BLOCK_POINTS).transpose(1, 0, 2)
        self._weights = np.ascontiguousarray(by_block)
        self._positions = np.ones((4, blocks * BLOCK_POINTS), np.float32)
        self.move(np.arange(self._count), positions)

    def move(self, which: NDArray[np.intp], positions: NDArray[np.float32]) -> None:
        """Give other positions (k, 3) to some of the points, (k,)."""
        self._positions[:3, which] = positions.T

    def skin(self, palette: NDArray[np.float32]) -> NDArray[np.float64]:
        """Return the points, (n, 3), moved by a palette (rows, 3, 4) without last rows."""
        # The threads of one large product would wait for each other on a busy machine.
        matrices = palette.reshape(-1, 12).T @ self._weights
        by_point = matrices.transpose(1, 0, 2).reshape(3, 4, -1)
        points = (by_point * self._positions).sum(axis=1)
        return np.asarray(points[:, : self._count].T, float)
