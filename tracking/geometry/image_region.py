"""Grey patches of an image, sampled between the pixels."""

from dataclasses import dataclass
from typing import Self

import cv2
import numpy as np

from cubeling.tracking.geometry.arrays import Array, Floats, Image

Region = tuple[int, int, int, int]
"""Left, top, right, bottom [px]; right and bottom are exclusive."""


@dataclass(frozen=True)
class Patch:
    """A rectangle of an image, in grey."""

    grey: Floats
    """Grey values, 0…255, (h, w)."""

    left: int
    """First column in the image [px]."""

    top: int
    """First row in the image [px]."""

    @classmethod
    def crop(cls, image: Image, region: Region | None = None, tone: Floats | None = None) -> Self:
        """Crop a region of an image, (H, W, 3) BGR or (H, W) grey, or take all of it.

        `tone` is the light for each grey value, (256,); None keeps the grey values.
        """
        left, top, right, bottom = region or (0, 0, image.shape[1], image.shape[0])
        part = image[top:bottom, left:right]
        grey = cv2.cvtColor(part, cv2.COLOR_BGR2GRAY) if part.ndim == 3 else part
        values = grey.astype(np.float32) if tone is None else cv2.LUT(grey, tone)
        return cls(np.asarray(values, np.float32), left, top)

    def border_distance(self, pixels: Array) -> Array:
        """Distance of pixels, (N, 2), to the nearest border, negative outside, (N,) [px]."""
        height, width = self.grey.shape
        inner = pixels - (self.left, self.top)
        least = np.minimum(inner, (width - 1, height - 1) - inner)
        return np.asarray(np.minimum(least[:, 0], least[:, 1]), np.float64)

    def sample(self, positions: Array) -> Floats:
        """Grey values between pixel centres, bilinear, positions (N, M, 2) [px] → (N, M)."""
        inner = (positions - (self.left, self.top)).astype(np.float32)
        return self.sample_local(inner[..., 0], inner[..., 1])

    def sample_local(self, x: Floats, y: Floats) -> Floats:
        """Do the same for columns and rows counted from the patch's own corner, (N, M) each.

        `remap` of 32-bit floats is exact in OpenCV 5; that of bytes rounds positions to 1/32 px,
        which is coarser than what is measured here (guarded by test_image_region.py).
        """
        values = cv2.remap(self.grey, x, y, cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE)
        return np.asarray(values, np.float32)

    def smooth(self, sigma: float) -> "Patch":
        """Return it blurred by a Gaussian of `sigma` [px]."""
        soft = cv2.GaussianBlur(self.grey, (0, 0), sigma)
        return Patch(np.asarray(soft, np.float32), self.left, self.top)
