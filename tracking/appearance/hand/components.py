"""Connected components of pixels."""

from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from cubeling.tracking.geometry.arrays import Flags, Image


def components_with(flags: Image, seeds: Flags | tuple[slice, slice]) -> Image:
    """Return the components of flagged pixels that hold one of the seeds, (h, w) 0 or 1.

    >>> components_with(np.array([[1, 1, 0, 1]], np.uint8), np.s_[:, :1]).tolist()
    [[1, 1, 0, 0]]
    """
    count, labels = cv2.connectedComponents(flags)
    kept = np.zeros(count, np.uint8)
    kept[labels[seeds]] = 1
    kept[0] = 0
    return np.asarray(kept[labels], np.uint8)


def at_border(labels: NDArray[Any], count: int) -> Flags:
    """Return which of `count` components are at the border of the picture of labels, (count,).

    >>> at_border(np.array([[0, 0, 0], [0, 1, 0], [2, 0, 0]]), 3).tolist()
    [True, False, True]
    """
    found = np.zeros(count, bool)
    for side in (labels[0], labels[-1], labels[:, 0], labels[:, -1]):
        found[side] = True
    return found
