"""Rays of a camera at sub-pixel positions, for ray casting."""

from dataclasses import dataclass

import cv2
import numpy as np

from cubeling.tracking.geometry.arrays import Array, Floats
from cubeling.tracking.geometry.intrinsics import Intrinsics
from cubeling.tracking.geometry.projection import Projection


class CameraRays:
    """The rays and the projection of a camera; pixel centres are at integers."""

    def __init__(self, intrinsics: Intrinsics, camera_from_table: Array | None = None) -> None:
        self.size = intrinsics.size
        self.intrinsics = intrinsics
        self.camera_from_table = np.eye(4) if camera_from_table is None else camera_from_table
        self._projection = Projection(intrinsics)
        width, height = intrinsics.size
        # A margin of one pixel, so that samples beyond the last pixel's centre can be interpolated.
        x, y = np.meshgrid(np.arange(-1.0, width + 1), np.arange(-1.0, height + 1))
        rays = self._projection.rays(np.stack([x.ravel(), y.ravel()], axis=1))
        self._rays = rays.reshape(height + 2, width + 2, 2).astype(np.float32)

    def pixels(self, points: Array) -> Array:
        """Project points of the camera frame, (n, 3) [m] → (n, 2) [px]."""
        return self._projection.project(points)

    def from_table(self, points: Array) -> Array:
        """Transform points of the table frame to the camera frame, (n, 3)."""
        return points @ self.camera_from_table[:3, :3].T + self.camera_from_table[:3, 3]

    def rays(self, region: "PixelRegion", samples: int) -> Floats:
        """Return the point at z = 1 on each sample's ray, (height · samples, width · samples, 2).

        Directions between pixel centres are interpolated, with an error below 0.001 px.
        """
        inside = (np.arange(samples, dtype=np.float32) + 0.5) / samples - 0.5
        x = (np.arange(region.x, region.right, dtype=np.float32)[:, None] + inside).ravel() + 1
        y = (np.arange(region.y, region.bottom, dtype=np.float32)[:, None] + inside).ravel() + 1
        grid = np.meshgrid(x, y)
        return np.asarray(cv2.remap(self._rays, grid[0], grid[1], cv2.INTER_LINEAR), np.float32)

    def whole(self) -> "PixelRegion":
        """Return the region of the whole image."""
        return PixelRegion(0, 0, *self.size)

    def region_around(self, pixels: Array, margin: float) -> "PixelRegion":
        """Return the bounding region of some pixels (n, 2), plus a margin, within the image."""
        low = np.clip(np.floor(pixels.min(axis=0) - margin), 0, self.size).astype(int)
        high = np.clip(np.ceil(pixels.max(axis=0) + margin) + 1, 0, self.size).astype(int)
        return PixelRegion(*low.tolist(), *(high - low).tolist())


@dataclass(frozen=True)
class PixelRegion:
    """A rectangle of pixels."""

    x: int
    y: int
    width: int
    height: int

    @property
    def right(self) -> int:
        """First column after it."""
        return self.x + self.width

    @property
    def bottom(self) -> int:
        """First row after it."""
        return self.y + self.height

    @property
    def empty(self) -> bool:
        """Whether it contains no pixel."""
        return self.width == 0 or self.height == 0

    @property
    def index(self) -> tuple[slice, slice]:
        """Index of the region in an image array."""
        return slice(self.y, self.bottom), slice(self.x, self.right)


def average_blocks(values: Floats, samples: int) -> Floats:
    """Average blocks of `samples`²: (h · samples, w · samples, n) → (h, w, n)."""
    height, width = values.shape[0] // samples, values.shape[1] // samples
    # INTER_AREA with an integer factor is the mean of each block.
    small = cv2.resize(values, (width, height), interpolation=cv2.INTER_AREA)
    return np.asarray(small, np.float32).reshape(height, width, -1)
