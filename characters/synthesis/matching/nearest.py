"""The nearest of many rows, exactly, and fast enough to ask for at every frame.

The rows are turned to their principal axes, which keeps distances, and halved again and again into
boxes of few rows. A query is bounded by the distances to the larger boxes, then to the smaller
boxes in the near ones, and only the rows of near small boxes are compared.
Method: the two layers of boxes of "Motion matching" in Unreal Engine and Ponton et al.,
"Environment-aware motion matching", SIGGRAPH Asia 2025, over boxes of a k-d tree (Bentley, 1975).
"""

import numpy as np
from numpy.typing import NDArray

from cubeling.characters.skeleton.pose import Array

_Array32 = NDArray[np.float32]

_BOX_ROWS = 32  # rows of a small box, at most
_SMALL_PER_LARGE = 16  # a power of two
_LARGE_AXES = 12  # principal axes along which distances to large boxes are measured
_FIRST_BOXES = 12  # the nearest boxes are compared first: they bound the rest
_FAR = 1e6  # of the rows that fill up a box


class NearestRow:
    """Finds the nearest of rows (rows, columns)."""

    def __init__(self, rows: Array) -> None:
        self._mean = rows.mean(0)
        centred = rows - self._mean
        _, axes = np.linalg.eigh(centred.T @ centred)
        self._axes = axes[:, ::-1].astype(np.float32)
        turned = centred.astype(np.float32) @ self._axes
        boxes = _halve(turned)
        size, columns = max(map(len, boxes)), turned.shape[1]
        self._numbers = np.zeros((len(boxes), size), np.intp)
        self._rows = np.full((len(boxes), size, columns), _FAR, np.float32)
        low, high = np.empty((2, len(boxes), columns), np.float32)
        for number, box in enumerate(boxes):
            self._numbers[number, : len(box)] = box
            self._rows[number, : len(box)] = turned[box]
            low[number], high[number] = turned[box].min(0), turned[box].max(0)
        self._per_large = min(_SMALL_PER_LARGE, len(boxes))
        shape = (-1, self._per_large, columns)
        low, high = low.reshape(shape), high.reshape(shape)
        self._small = _Boxes(low, high)
        self._large = _Boxes(low.min(1)[:, :_LARGE_AXES], high.max(1)[:, :_LARGE_AXES])

    def find(self, query: Array, bound: float = np.inf) -> tuple[int, float] | None:
        """Return the number of the nearest row and its squared distance.

        None if no row is nearer than the squared distance `bound`.
        """
        asked: _Array32 = (query - self._mean).astype(np.float32) @ self._axes
        far = self._large.distances(asked)
        found: tuple[int, float] | None = None
        # The nearest small box of the nearest large one bounds the search.
        nearest = int(far.argmin())
        inner = self._small.distances(asked, np.array([nearest]))[0]
        first = nearest * self._per_large + int(inner.argmin())
        found, bound = self._nearer(asked, np.array([first]), found, bound)
        near = np.flatnonzero(far < bound)
        distances = self._small.distances(asked, near)
        keep = distances < bound
        boxes = (near[:, None] * self._per_large + np.arange(self._per_large))[keep]
        distances = distances[keep]
        if len(boxes) > 2 * _FIRST_BOXES:
            order = np.argpartition(distances, _FIRST_BOXES)
            boxes, distances = boxes[order], distances[order]
            found, bound = self._nearer(asked, boxes[:_FIRST_BOXES], found, bound)
            boxes = boxes[_FIRST_BOXES:][distances[_FIRST_BOXES:] < bound]
        return self._nearer(asked, boxes, found, bound)[0]

    def _nearer(
        self,
        asked: _Array32,
        boxes: NDArray[np.intp],
        found: tuple[int, float] | None,
        bound: float,
    ) -> tuple[tuple[int, float] | None, float]:
        """Return what was found, or a nearer row in some boxes, and the new bound."""
        if not len(boxes):
            return found, bound
        apart = self._rows[boxes] - asked
        distances = np.einsum("ijk,ijk->ij", apart, apart)
        best = int(distances.argmin())
        distance = float(distances.flat[best])
        if distance >= bound:
            return found, bound
        return (int(self._numbers[boxes].flat[best]), distance), distance


class _Boxes:
    """Boxes (…, axes), and how far they are at least."""

    def __init__(self, low: _Array32, high: _Array32) -> None:
        self._middle, self._half = (low + high) / 2, (high - low) / 2

    def distances(
        self, point: _Array32, some: "NDArray[np.intp] | slice" = slice(None)
    ) -> _Array32:
        """Return squared distances of a point to some boxes, (…)."""
        apart = np.abs(self._middle[some] - point[: self._middle.shape[-1]])
        apart -= self._half[some]
        np.maximum(apart, 0.0, out=apart)
        squared: _Array32 = np.einsum("...i,...i->...", apart, apart)
        return squared


def _halve(rows: _Array32) -> list[NDArray[np.intp]]:
    """Return a power of two of boxes, as numbers of rows, each halved along its longest side."""
    boxes = [np.arange(len(rows))]
    while max(map(len, boxes)) > _BOX_ROWS:
        halves: list[NDArray[np.intp]] = []
        for box in boxes:
            along = rows[box][:, rows[box].var(0).argmax()]
            order, half = np.argsort(along, kind="stable"), len(box) // 2
            halves += [box[order[:half]], box[order[half:]]]
        boxes = halves
    return boxes
