"""What every distance between frames is, and how all of them are computed."""

from collections.abc import Iterator
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from cubeling.characters.skeleton.pose import Array
from cubeling.characters.synthesis.library import Frames

Block = NDArray[np.float32]
"""Distances of some frames (rows) to others (columns)."""

TILE_FRAMES = (256, 1024)
"""Largest number of rows and columns of a block: its float32 numbers fit into a core's cache."""


class FrameDistance(Protocol):
    """How unlike two frames of a library are: symmetric, not negative, 0 for equal frames.

    It does not change with the place and heading of either frame, nor with the signs of its
    quaternions. It need not satisfy the triangle inequality: most are squared.
    """

    def __len__(self) -> int:
        """Return the number of frames."""
        ...

    def block(self, rows: Frames, columns: Frames) -> Block:
        """Return the distances of frames to frames, to single precision."""
        ...

    def pairs(self, a: Frames, b: Frames) -> Array:
        """Return the distances of frames `a` (n,) to frames `b` (n,), to double precision."""
        ...


def tiles(rows: Frames, columns: Frames) -> Iterator[tuple[Frames, Frames]]:
    """Yield the blocks that cover frames times frames."""
    for top in range(0, len(rows), TILE_FRAMES[0]):
        for left in range(0, len(columns), TILE_FRAMES[1]):
            yield rows[top : top + TILE_FRAMES[0]], columns[left : left + TILE_FRAMES[1]]


def distance_matrix(distance: FrameDistance) -> Block:
    """Return all distances, (frames, frames): exactly symmetric, exactly zero on the diagonal.

    Only the blocks on and above the diagonal are computed.
    """
    count = len(distance)
    result = np.empty((count, count), np.float32)
    for rows, columns in tiles(np.arange(count), np.arange(count)):
        if columns[-1] >= rows[0]:
            result[rows[0] : rows[-1] + 1, columns[0] : columns[-1] + 1] = distance.block(
                rows, columns
            )
    for top in range(0, count, TILE_FRAMES[1]):
        side = slice(top, min(top + TILE_FRAMES[1], count))
        result[side, : side.start] = result[: side.start, side].T
        corner = np.triu(result[side, side], 1)
        result[side, side] = corner + corner.T
    return result


def squared_differences(a: NDArray[np.float32], b: NDArray[np.float32]) -> Block:
    """Return |a − b|² of all rows of a (n, k) and b (m, k), as one product."""
    result: Block = a @ b.T
    result *= -2.0
    result += np.einsum("ij,ij->i", a, a)[:, None]
    result += np.einsum("ij,ij->i", b, b)
    np.maximum(result, 0.0, out=result)
    return result
