"""A loop on the table to walk along."""

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


class ClosedPath:
    """The closed line through some points, walked by following a carrot on a stick.

    Parameters
    ----------
    points
        Corners of the loop, (n, 2) [m]; at least two of them apart.
    """

    def __init__(self, points: Array) -> None:
        self._points = np.asarray(points, float)
        self._steps = np.roll(self._points, -1, axis=0) - self._points
        self._lengths = np.linalg.norm(self._steps, axis=1)
        if not self._lengths.sum() > 0.0:
            raise ValueError("a path needs two points that are apart")
        self._starts = np.concatenate([[0.0], np.cumsum(self._lengths)[:-1]])
        self._carrot: float | None = None

    @property
    def length(self) -> float:
        """Once round [m]."""
        return float(self._lengths.sum())

    def at(self, along: float) -> Array:
        """Return the point (2,) that lies `along` metres down the path, any number of times round.

        >>> ClosedPath(np.array([[0., 0.], [1., 0.], [1., 1.], [0., 1.]])).at(5.5).tolist()
        [1.0, 0.5]
        """
        along %= self.length
        leg = int(np.searchsorted(self._starts, along, side="right")) - 1
        share = (along - self._starts[leg]) / self._lengths[leg] if self._lengths[leg] else 0.0
        return np.asarray(self._points[leg] + share * self._steps[leg])

    def nearest(self, position: Array) -> float:
        """How far down the path the point nearest to `position` (2,) lies [m]."""
        offsets = np.asarray(position, float) - self._points
        squares = np.maximum(self._lengths**2, np.finfo(float).tiny)
        shares = np.clip(np.einsum("ij,ij->i", offsets, self._steps) / squares, 0.0, 1.0)
        gaps = np.linalg.norm(shares[:, None] * self._steps - offsets, axis=1)
        leg = int(np.argmin(gaps))
        return float(self._starts[leg] + shares[leg] * self._lengths[leg])

    def ahead(self, position: Array, distance: float) -> Array:
        """Return the point (2,) to head for from `position`, `distance` metres away if it can be.

        The point only ever moves forwards, so a path that crosses itself is walked in its order.
        """
        if self._carrot is None:
            self._carrot = self.nearest(position)
        step = distance / CARROT_STEPS
        for _ in range(int(self.length / step) + 1):
            if float(np.linalg.norm(self.at(self._carrot) - position)) >= distance:
                break
            self._carrot += step
        return self.at(self._carrot)


CARROT_STEPS = 16
"""Into how many steps the stick is cut when the carrot moves on."""
