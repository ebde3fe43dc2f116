"""What a hand covers of the camera's image."""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from tracking.geometry.arrays import Array

EDGE_SLOPE = 255 / 90
"""How steeply the share of a pixel rises where half of it is covered, relative to what is
interpolated between the squares of a mask, which are larger."""


@dataclass(frozen=True)
class HandMask:
    """What the hand covers of the image near the cube."""

    x: int
    """First column of the camera's frame that `share` is of [px]."""

    y: int
    """First row [px]."""

    share: NDArray[np.uint8]
    """Share of each square of pixels that the hand covers, 0…255, (height, width)."""

    scale: int
    """Side of these squares [px]."""

    behind: Array
    """The nearest point of the cube that the hand hides, in the camera's frame, (3,) [m]: the hand
    is nearer. The cube's centre where the hand hides no face."""

    def moved(self, right: int, down: int) -> "HandMask":
        """Return the same after a move by some pixels, perhaps out of the image."""
        return replace(self, x=self.x + right, y=self.y + down)
