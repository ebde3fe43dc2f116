"""What a hand covers of the camera's image."""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from cubeling.tracking.geometry.arrays import Array

EDGE_SLOPE = 255 / 90
"""How steeply the share of a pixel rises where half of it is covered, relative to what is
interpolated between the squares of a mask, which are larger."""


@dataclass(frozen=True)
class HandMask:
    """What the hand covers of the image near the cube."""

    x: int
    """First column of the camera's frame that `share` is of [px]."""

    y: int
    """First row of the picture that it covers [px]."""

    share: NDArray[np.uint8]
    """Share of each square of pixels that the hand covers, 0…255, (height, width)."""

    behind: Array
    """The nearest point of the cube that the hand hides, in the camera's frame, (3,) [m]: the hand
    is nearer. The cube's centre where the hand hides no face."""

    scale: int = 1
    """Side of these squares [px]."""

    slope: float = 1.0
    """How steeply the share of a pixel rises where half is covered, relative to what is
    interpolated between squares: an edge is sharper than they are large."""

    def move(self, right: int, down: int, step: Array) -> "HandMask":
        """Return the same after a move, `step`, (3,) in metres, by some pixels of the image."""
        return replace(self, x=self.x + right, y=self.y + down, behind=self.behind + step)

    def agreement(self, other: "HandMask") -> float:
        """Return the soft IoU with another mask, 0…1: the lesser over the greater shares of all.

        Masks of other squares do not agree.
        """
        if self.scale != other.scale:
            return 0.0
        right, down = (
            round((there - here) / self.scale)
            for here, there in ((self.x, other.x), (self.y, other.y))
        )
        here = self.share[max(down, 0) :, max(right, 0) :]
        there = other.share[max(-down, 0) :, max(-right, 0) :]
        height, width = np.minimum(here.shape, there.shape)
        both = int(np.minimum(here[:height, :width], there[:height, :width]).sum())
        either = int(self.share.sum()) + int(other.share.sum()) - both
        return both / max(either, 1)
