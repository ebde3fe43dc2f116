"""Sub-pixel rays through the lens, for drawing by looking backwards from every pixel."""

import cv2
import numpy as np
from numpy.typing import NDArray

from tracking.geometry.intrinsics import Intrinsics
from tracking.geometry.projection import Projection

Array = NDArray[np.float64]
Rays = NDArray[np.float32]


class Lens:
    """The camera's rays, and where points appear; pixel centres at whole numbers.

    Parameters
    ----------
    intrinsics
        The camera.
    """

    def __init__(self, intrinsics: Intrinsics) -> None:
        self.size = intrinsics.size
        self.intrinsics = intrinsics
        self._projection = Projection(intrinsics)
        width, height = intrinsics.size
        # A margin of one pixel, so that samples beside the last pixel's centre have neighbours.
        x, y = np.meshgrid(np.arange(-1.0, width + 1), np.arange(-1.0, height + 1))
        rays = self._projection.rays(np.stack([x.ravel(), y.ravel()], axis=1))
        self._rays = rays.reshape(height + 2, width + 2, 2).astype(np.float32)

    def pixels(self, points: Array) -> Array:
        """Project points of the camera frame, (n, 3) [m] → (n, 2) [px]."""
        return self._projection.project(points)

    def rays(self, region: "Region", finer: int) -> Rays:
        """Return points at z = 1 for every sample of a region.

        Between the pixels' centres they are interpolated: a lens bends so little over one pixel
        that this is true to a thousandth of one.

        Returns
        -------
        (height · finer, width · finer, 2)
        """
        inside = (np.arange(finer, dtype=np.float32) + 0.5) / finer - 0.5
        x = (np.arange(region.x, region.right, dtype=np.float32)[:, None] + inside).ravel() + 1
        y = (np.arange(region.y, region.bottom, dtype=np.float32)[:, None] + inside).ravel() + 1
        grid = np.meshgrid(x, y)
        return np.asarray(cv2.remap(self._rays, grid[0], grid[1], cv2.INTER_LINEAR), np.float32)

    def whole(self) -> "Region":
        """Return the whole picture."""
        return Region(0, 0, *self.size)

    def around(self, pixels: Array, margin: float) -> "Region":
        """Return the smallest region of the picture that holds some pixels (n, 2) and a margin."""
        low = np.floor(pixels.min(axis=0) - margin)
        high = np.ceil(pixels.max(axis=0) + margin) + 1
        low = np.clip(low, 0, self.size).astype(int)
        high = np.clip(high, 0, self.size).astype(int)
        return Region(int(low[0]), int(low[1]), int(high[0] - low[0]), int(high[1] - low[1]))


class Region:
    """A rectangle of whole pixels."""

    def __init__(self, x: int, y: int, width: int, height: int) -> None:
        self.x, self.y, self.width, self.height = x, y, max(0, width), max(0, height)

    @property
    def right(self) -> int:
        """First column beyond it."""
        return self.x + self.width

    @property
    def bottom(self) -> int:
        """First row beyond it."""
        return self.y + self.height

    @property
    def empty(self) -> bool:
        """Whether it holds no pixel."""
        return self.width == 0 or self.height == 0

    @property
    def of(self) -> tuple[slice, slice]:
        """Index of the region in a picture."""
        return slice(self.y, self.bottom), slice(self.x, self.right)


def averaged(samples: NDArray[np.float32], finer: int) -> NDArray[np.float32]:
    """Average blocks of `finer` × `finer` samples: (h · finer, w · finer, n) → (h, w, n)."""
    if finer == 1:
        return samples
    height, width = samples.shape[0] // finer, samples.shape[1] // finer
    # INTER_AREA by a whole factor is the plain mean of each block.
    small = cv2.resize(samples, (width, height), interpolation=cv2.INTER_AREA)
    return np.asarray(small, np.float32).reshape(height, width, -1)
