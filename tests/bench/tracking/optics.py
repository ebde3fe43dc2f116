"""The benchmark's camera: lens, blur and sensor. Shares no code with the tracker.

The lens model is Brown's (1971) with OpenCV's order of coefficients, inverted by Newton's method.
Light is linear until `develop` adds noise and applies the sRGB curve.
"""

from dataclasses import dataclass, replace
from functools import cached_property

import cv2
import numpy as np
from numpy.typing import NDArray

SUBPIXELS = 2
"""Sub-pixels per pixel and axis on which rays are cast and the lens blurs."""

ROWS_AT_ONCE = 8
"""Rows of sub-pixels whose rays are found together: they fit into the processor's cache."""


@dataclass(frozen=True, eq=False)
class LensModel:
    """Rays of a camera. Pixel centres have integer coordinates."""

    matrix: NDArray[np.float64]
    """Focal lengths and principal point [px], (3, 3)."""

    distortion: NDArray[np.float64]
    """k1, k2, p1, p2, k3, (5,)."""

    size: tuple[int, int]
    """Width and height [px]."""

    gauss: float = 0.55
    """Standard deviation of diffraction, aberrations and the sensor's filter [px]."""

    disk: float = 0.87
    """Radius of the circle of confusion at the distance of focus [px]."""

    focus: float = 0.5
    """Distance of focus along the optical axis [m]."""

    aperture: float = 0.0
    """How fast the circle grows: its radius by the difference of 1 ÷ distance [px m].

    Focal length [px] times the radius of the aperture [m]; 0 where all depths are equally sharp.
    """

    def spread(self, depth: float) -> NDArray[np.float32]:
        """Blur of what lies `depth` [m] away along the optical axis, on the sub-pixels."""
        circle = self.disk + self.aperture * abs(1 / self.focus - 1 / depth)
        return point_spread(self.gauss, circle)

    def halved(self) -> "LensModel":
        """Return the lens of the same pictures at half size; draws nothing itself."""
        matrix = self.matrix / np.array([[2], [2], [1]])
        matrix[:2, 2] -= 0.25  # pixel centres are at integers
        width, height = self.size
        return replace(self, matrix=matrix, size=(width // 2, height // 2))

    def bend(
        self, x: NDArray[np.float64], y: NDArray[np.float64]
    ) -> tuple[NDArray[np.float64], ...]:
        """Distort ideal image coordinates at depth 1.

        Brown, "Close-range camera calibration", 1971: radial and tangential terms.

        Returns
        -------
        The distorted x and y, and their derivatives: of x by x, of y by y, and of one by the other.
        """
        k1, k2, p1, p2, k3 = self.distortion
        square = x * x + y * y
        radial = 1 + square * (k1 + square * (k2 + square * k3))
        # The slope of `radial` by the squared radius; the squared radius has the slope (2x, 2y).
        slope = k1 + square * (2 * k2 + square * 3 * k3)
        return (
            x * radial + 2 * p1 * x * y + p2 * (square + 2 * x * x),
            y * radial + p1 * (square + 2 * y * y) + 2 * p2 * x * y,
            radial + 2 * x * x * slope + 2 * p1 * y + 6 * p2 * x,
            radial + 2 * y * y * slope + 6 * p1 * y + 2 * p2 * x,
            2 * x * y * slope + 2 * p1 * x + 2 * p2 * y,
        )

    def project(self, points: NDArray[np.float64]) -> NDArray[np.float64]:
        """Pixels (..., 2) of points (..., 3) in the camera frame [m], in front of the camera."""
        ideal = points[..., :2] / points[..., 2:]
        bent = np.stack(self.bend(ideal[..., 0], ideal[..., 1])[:2], axis=-1)
        return np.asarray(bent * self.matrix[[0, 1], [0, 1]] + self.matrix[:2, 2])

    def directions(self, pixels: NDArray[np.float64]) -> NDArray[np.float64]:
        """Where rays through `pixels` (..., 2) meet the plane at depth 1, (..., 2)."""
        target = (pixels - self.matrix[:2, 2]) / self.matrix[[0, 1], [0, 1]]
        # Loops over two values take twice as long as those over a whole array of each.
        x_there, y_there = target[..., 0].copy(), target[..., 1].copy()
        x, y = x_there, y_there
        for _ in range(4):  # Newton's method: the error squares in each round.
            x_bent, y_bent, x_by_x, y_by_y, mixed = self.bend(x, y)
            x_off, y_off = x_bent - x_there, y_bent - y_there
            size = x_by_x * y_by_y - mixed * mixed
            x = x - (y_by_y * x_off - mixed * y_off) / size
            y = y - (x_by_x * y_off - mixed * x_off) / size
        return np.stack([x, y], axis=-1)

    @cached_property
    def rays(self) -> NDArray[np.float32]:
        """`directions` of every sub-pixel's centre, (H · SUBPIXELS, W · SUBPIXELS, 2)."""
        width, height = self.size
        pixels = np.empty((height * SUBPIXELS, width * SUBPIXELS, 2))
        pixels[..., 0] = (np.arange(width * SUBPIXELS) + 0.5) / SUBPIXELS - 0.5
        pixels[..., 1] = ((np.arange(height * SUBPIXELS) + 0.5) / SUBPIXELS - 0.5)[:, None]
        found = np.empty(pixels.shape, np.float32)
        for top in range(0, len(pixels), ROWS_AT_ONCE):
            rows = np.s_[top : top + ROWS_AT_ONCE]
            found[rows] = self.directions(pixels[rows])
        return found

    @cached_property
    def vignette(self) -> NDArray[np.float32]:
        """Share of the light that arrives at each pixel, (height, width).

        A thin lens lets it fall with cos⁴ of the angle; webcams correct a part, so here with cos².
        """
        width, height = self.size
        x = (np.arange(width) - self.matrix[0, 2]) / self.matrix[0, 0]
        y = (np.arange(height) - self.matrix[1, 2]) / self.matrix[1, 1]
        return np.asarray(1 / (1 + x[None] ** 2 + y[:, None] ** 2), np.float32)


def point_spread(gauss: float = 0.55, disk: float = 0.87) -> NDArray[np.float32]:
    """Return the blur of the lens on the sub-pixel grid, odd and square, summing to 1.

    Parameters
    ----------
    gauss
        Standard deviation of diffraction, aberrations and the sensor's filter [px].
    disk
        Radius of the circle of confusion [px]. Together with `gauss`: 0.70 px per axis.
    """
    reach, dense = int(np.ceil(SUBPIXELS * (disk + 2.5 * gauss))), 9
    grid = (np.arange((2 * reach + 1) * dense) + 0.5) / dense - reach - 0.5
    inside = (grid[None] ** 2 + grid[:, None] ** 2 <= (disk * SUBPIXELS) ** 2).astype(np.float64)
    cells = inside.reshape(2 * reach + 1, dense, 2 * reach + 1, dense).mean((1, 3))
    bell = np.exp(-0.5 * (np.arange(-reach, reach + 1) / (gauss * SUBPIXELS)) ** 2)
    kernel = cv2.sepFilter2D(cells, cv2.CV_64F, bell, bell, borderType=cv2.BORDER_CONSTANT)
    return np.asarray(kernel / kernel.sum(), np.float32)


@dataclass(frozen=True)
class Sensor:
    """Converts linear light to 8 bit: shot and read noise, then the sRGB curve."""

    electrons: float = 4000.0
    """Electrons of a pixel at full scale; fewer in the dark, where the gain is higher."""

    read_noise: float = 5.0
    """Noise of reading a pixel [electrons]."""

    halved: bool = False
    """Whether the camera gives pictures of half the size: means of 2 by 2 pixels."""

    quality: int | None = None
    """JPEG quality of the pictures, 0…100; None if they are not compressed."""

    def develop(self, light: NDArray[np.float32], random: np.random.Generator) -> NDArray[np.uint8]:
        """Picture (H, W, 3) BGR of linear light (H, W, 3), 1 being white; overwrites `light`.

        The noise is in luminance only: webcams filter out colour noise.
        """
        mean = np.maximum(light[..., 1], 0)
        spread = np.sqrt(mean / self.electrons + (self.read_noise / self.electrons) ** 2)
        spread *= random.standard_normal(mean.shape, np.float32)
        light += spread[..., None]
        levels = (SRGB_TABLE.size - 1) * np.clip(light, 0, 1, out=light)
        picture = np.take(SRGB_TABLE, levels.astype(np.uint16))
        if self.halved:
            half = cv2.resize(picture, None, fx=0.5, fy=0.5, interpolation=cv2.INTER_AREA)
            picture = np.asarray(half, np.uint8)
        return picture if self.quality is None else compressed(picture, self.quality)


def compressed(picture: NDArray[np.uint8], quality: int) -> NDArray[np.uint8]:
    """Return what is left of a picture after JPEG compression, `quality` being 0…100."""
    _, file = cv2.imencode(".jpg", picture, [cv2.IMWRITE_JPEG_QUALITY, quality])
    opened = cv2.imdecode(file, cv2.IMREAD_COLOR)
    assert opened is not None
    return np.asarray(opened, np.uint8)


def srgb_encoded(light: NDArray[np.float64]) -> NDArray[np.float64]:
    """Curve of sRGB (IEC 61966-2-1): linear light 0…1 to 0…1."""
    return np.where(light <= 0.0031308, 12.92 * light, 1.055 * light ** (1 / 2.4) - 0.055)


SRGB_TABLE = np.rint(255 * srgb_encoded((np.arange(1 << 14) + 0.5) / (1 << 14))).astype(np.uint8)
"""8-bit value of each of 2¹⁴ equal steps of linear light."""


def sampled(
    picture: NDArray[np.float32], grid: NDArray[np.float32], smooth: bool
) -> NDArray[np.float32]:
    """Values of `picture` at columns and rows `grid` (h, w, 2).

    If `smooth`, between pixels and mirrored at the rim; else those of the nearest pixel, and 0
    outside.
    """
    way, rim = cv2.INTER_NEAREST, cv2.BORDER_CONSTANT
    if smooth:
        way, rim = cv2.INTER_LINEAR, cv2.BORDER_REFLECT
    # One map of pairs needs no second; the stubs know of no None, and an empty array hangs.
    found = cv2.remap(picture, grid, None, way, borderMode=rim)  # type: ignore[call-overload]
    return np.asarray(found, np.float32)
