"""Closed paths on the table to walk along."""

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

_STEPS_PER_DISTANCE = 16
"""Number of steps, for the look-ahead distance, by which the look-ahead point advances."""


class ClosedPath:
    """A closed polyline with a look-ahead point to follow (pure pursuit).

    Parameters
    ----------
    points
        Corners of the path, (n, 2) [m]; at least two of them differ.
    """

    def __init__(self, points: Array) -> None:
        self._points = np.asarray(points, float)
        self._edges = np.roll(self._points, -1, axis=0) - self._points
        self._lengths = np.linalg.norm(self._edges, axis=1)
        if not self._lengths.sum() > 0.0:
            raise ValueError("a path needs two different points")
        self._starts = np.concatenate([[0.0], np.cumsum(self._lengths)[:-1]])
        self._look_ahead: float | None = None

    @property
    def length(self) -> float:
        """Length of one round [m]."""
        return float(self._lengths.sum())

    def at(self, along: float) -> Array:
        """Return the point (2,) at a distance `along` the path [m], over any number of rounds.

        >>> ClosedPath(np.array([[0., 0.], [1., 0.], [1., 1.], [0., 1.]])).at(5.5).tolist()
        [1.0, 0.5]
        """
        along %= self.length
        edge = int(np.searchsorted(self._starts, along, side="right")) - 1
        length = self._lengths[edge]
        share = (along - self._starts[edge]) / length if length else 0.0
        return np.asarray(self._points[edge] + share * self._edges[edge])

    def nearest(self, position: Array) -> float:
        """Return the distance along the path of its point nearest to a position (2,) [m]."""
        offsets = np.asarray(position, float) - self._points
        squares = np.maximum(self._lengths**2, np.finfo(float).tiny)
        shares = np.clip(np.einsum("ij,ij->i", offsets, self._edges) / squares, 0.0, 1.0)
        gaps = np.linalg.norm(shares[:, None] * self._edges - offsets, axis=1)
        edge = int(np.argmin(gaps))
        return float(self._starts[edge] + shares[edge] * self._lengths[edge])

    def ahead(self, position: Array, distance: float) -> Array:
        """Return the point (2,) to head for from a position, `distance` [m] away if possible.

        The point only moves forward, so a path that crosses itself is followed in its order.
        """
        if self._look_ahead is None:
            self._look_ahead = self.nearest(position)
        step = distance / _STEPS_PER_DISTANCE
        for _ in range(int(self.length / step) + 1):
            if float(np.linalg.norm(self.at(self._look_ahead) - position)) >= distance:
                break
            self._look_ahead += step
        return self.at(self._look_ahead)
