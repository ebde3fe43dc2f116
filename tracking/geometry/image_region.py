"""The part of a grey picture that the tracker looks at, and its values between the pixels."""

from dataclasses import dataclass
from typing import Self

import cv2
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

Floats = NDArray[np.float32]

BORDER = cv2.BORDER_REPLICATE

Region = tuple[int, int, int, int]
"""Left, top, right, bottom [px]; right and bottom are not part of it."""


@dataclass(frozen=True)
class Patch:
    """A rectangle of a picture, in grey."""

    grey: Floats
    """Grey values, 0…255, (h, w)."""

    left: int
    """Column of the picture in which it begins [px]."""

    top: int
    """Row of the picture in which it begins [px]."""

    @classmethod
    def of(
        cls,
        image: NDArray[np.uint8],
        region: Region | None = None,
        tone: Floats | None = None,
    ) -> Self:
        """Cut a region out of a picture.

        Parameters
        ----------
        image
            The picture, (H, W, 3) BGR or (H, W) grey.
        region
            What to cut out; None for all of it.
        tone
            What each grey value stands for, (256,); None for itself.
        """
        left, top, right, bottom = region or (0, 0, image.shape[1], image.shape[0])
        part = image[top:bottom, left:right]
        grey = cv2.cvtColor(part, cv2.COLOR_BGR2GRAY) if part.ndim == 3 else part
        values = grey.astype(np.float32) if tone is None else cv2.LUT(grey, tone)
        return cls(np.asarray(values, np.float32), left, top)

    def room(self, pixels: Array) -> Array:
        """Distance of pixels, (N, 2), to the nearest border, negative outside, (N,) [px]."""
        height, width = self.grey.shape
        inner = pixels - (self.left, self.top)
        least = np.minimum(inner, (width - 1, height - 1) - inner)
        return np.asarray(np.minimum(least[:, 0], least[:, 1]), np.float64)

    def at(self, places: Array) -> Floats:
        """Grey values between pixel centres, bilinear, places (N, M, 2) [px] → (N, M)."""
        inner = (places - (self.left, self.top)).astype(np.float32)
        return self.inside(inner[..., 0], inner[..., 1])

    def inside(self, x: Floats, y: Floats) -> Floats:
        """Do the same for columns and rows of this part, (N, M) each, counted from its corner.

        `remap` of 32 bit floats is exact in OpenCV 5; that of bytes rounds places to 1/32 px, which
        is coarser than what is measured here (test_image_region.py guards it).
        """
        values = cv2.remap(self.grey, x, y, cv2.INTER_LINEAR, borderMode=BORDER)
        return np.asarray(values, np.float32)

    def smoothed(self, sigma: float) -> "Patch":
        """Blur it by a Gaussian of `sigma` [px]."""
        soft = cv2.GaussianBlur(self.grey, (0, 0), sigma)
        return Patch(np.asarray(soft, np.float32), self.left, self.top)
