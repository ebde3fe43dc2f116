"""Connected components of pixels."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from tracking.geometry.arrays import Flags


def at_border(labels: NDArray[Any], count: int) -> Flags:
    """Return which of `count` components are at the border of the picture of labels, (count,).

    >>> at_border(np.array([[0, 0, 0], [0, 1, 0], [2, 0, 0]]), 3).tolist()
    [True, False, True]
    """
    found = np.zeros(count, bool)
    for side in (labels[0], labels[-1], labels[:, 0], labels[:, -1]):
        found[side] = True
    return found
