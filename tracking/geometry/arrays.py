"""The array types of this room, and runs of equal numbers."""

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Floats = NDArray[np.float32]
Image = NDArray[np.uint8]
Indices = NDArray[np.intp]
Flags = NDArray[np.bool_]


def run_starts(numbers: Indices) -> Indices:
    """Return where each run of equal numbers begins, for `np.add.reduceat`.

    >>> run_starts(np.array([4, 4, 7, 2])).tolist()
    [0, 2, 3]
    """
    changes = np.ones(len(numbers), np.bool_)
    np.not_equal(numbers[1:], numbers[:-1], out=changes[1:])
    return np.flatnonzero(changes)
