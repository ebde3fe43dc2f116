"""The vertices that stand out: they tell how far a character reaches, without all the others."""

import numpy as np
from numpy.typing import NDArray


def _surface(side: int) -> NDArray[np.float32]:
    """Return the directions (n, 3) of a grid on the surface of a cube, `side` points an edge.

    >>> _surface(3).shape, _surface(5).shape
    ((26, 3), (98, 3))
    """
    grid = np.stack(np.meshgrid(*[np.linspace(-1.0, 1.0, side)] * 3), axis=-1).reshape(-1, 3)
    shell = grid[np.abs(grid).max(axis=1) == 1.0]
    return np.asarray(shell / np.linalg.norm(shell, axis=1, keepdims=True), np.float32)


WAYS, FINE_WAYS = _surface(3), _surface(5)
"""Directions in which the vertices that stand out are looked for: of most joints, and of those
that move much of the character. A ball goes past what is known of it by 10 % or by 3 % of its
radius."""

MUCH = 0.3
"""Share of the character's size from which on what one joint moves is much of it."""


def furthest(positions: NDArray[np.float32], owner: NDArray[np.uint32]) -> NDArray[np.intp]:
    """Return the numbers of those that are, of one owner's, the furthest in some direction."""
    order = np.argsort(owner, kind="stable")
    borders = np.flatnonzero(np.diff(owner[order])) + 1
    lying = np.ascontiguousarray(positions[order].T)  # a coordinate a row, read in one go
    much = MUCH * np.ptp(lying, axis=1).max()
    found = []
    for run, own in zip(np.split(order, borders), np.split(lying, borders, axis=1), strict=True):
        ways = FINE_WAYS if np.ptp(own, axis=1).max() > much else WAYS
        # Not a matrix product: its threads would wait for each other on a busy machine.
        found.append(run[np.einsum("wk,kv->wv", ways, own).argmax(axis=1)])
    return np.unique(np.concatenate(found))
