"""From OpenCV's pinhole matrix to OpenGL's clip space, and rectangles in the picture."""

import math
from dataclasses import dataclass

import numpy as np

from cubeling.characters.skeleton.pose import Array

NEAR_M, FAR_M = 0.02, 20.0
"""Depths of the near and far planes [m]: from a hand at the lens to the end of a room."""

MARGIN_PX, RELATIVE_MARGIN = 3, 0.02
"""Margin around projected points: pixels, and a share of their extent, as few stand for many."""

SIZE_STEP_PX = 64
"""Sizes of textures are rounded up to a multiple, so that a walking character does not need a new
one in each picture."""

MIN_RELATIVE_VOLUME = 1e-6
"""Determinant of a transform's axes over the product of their lengths; less counts as singular."""


@dataclass(frozen=True)
class Rectangle:
    """An area of the picture in whole pixels."""

    x: int
    """Left column, in pixels of the picture."""

    y: int
    """Top row, in pixels of the picture."""

    width: int
    """Number of columns, in pixels of the picture."""

    height: int
    """Number of rows, in pixels of the picture."""

    @property
    def slices(self) -> tuple[slice, slice]:
        """Index of the area in an image array: rows, columns."""
        return slice(self.y, self.y + self.height), slice(self.x, self.x + self.width)

    def intersection(self, other: "Rectangle") -> "Rectangle | None":
        """Return the pixels in both, or None where there are none.

        >>> Rectangle(0, 0, 2, 2).intersection(Rectangle(1, 1, 5, 5))
        Rectangle(x=1, y=1, width=1, height=1)
        >>> Rectangle(0, 0, 2, 2).intersection(Rectangle(2, 0, 5, 5))
        """
        x, y = max(self.x, other.x), max(self.y, other.y)
        right = min(self.x + self.width, other.x + other.width)
        bottom = min(self.y + self.height, other.y + other.height)
        return Rectangle(x, y, right - x, bottom - y) if right > x and bottom > y else None

    def within(self, other: "Rectangle") -> "Rectangle":
        """Return the same pixels, counted from the first pixel of another rectangle."""
        return Rectangle(self.x - other.x, self.y - other.y, self.width, self.height)

    def union(self, other: "Rectangle") -> "Rectangle":
        """Return the smallest rectangle that contains both.

        >>> Rectangle(0, 0, 2, 2).union(Rectangle(3, 1, 1, 4))
        Rectangle(x=0, y=0, width=4, height=5)
        """
        x, y = min(self.x, other.x), min(self.y, other.y)
        right = max(self.x + self.width, other.x + other.width)
        bottom = max(self.y + self.height, other.y + other.height)
        return Rectangle(x, y, right - x, bottom - y)


def clip_from_camera(matrix: Array, area: Rectangle) -> Array:
    """Return the projection that draws one area of a picture into a viewport of the same size.

    OpenCV puts the centre of the top left pixel at (0, 0), OpenGL the corner of a viewport, hence
    the offsets of 0.5. Row 0 of the viewport is the top row, so the result needs no flip. `matrix`
    (3, 3) [px] is that of the whole picture. The result (4, 4) takes points in the camera frame.

    >>> k = np.array([[100., 0, 31.5], [0, 100, 23.5], [0, 0, 1]])
    >>> clip = clip_from_camera(k, Rectangle(0, 0, 64, 48)) @ [0, 0, 1, 1]
    >>> clip[:2].tolist(), float(clip[3])
    ([0.0, 0.0], 1.0)
    """
    (fx, skew, cx), (_, fy, cy) = matrix[0], matrix[1]
    scale_x, scale_y = 2.0 / area.width, 2.0 / area.height
    depth = (FAR_M + NEAR_M) / (FAR_M - NEAR_M)
    return np.array(
        [
            [scale_x * fx, scale_x * skew, scale_x * (cx + 0.5 - area.x) - 1.0, 0.0],
            # +y, unlike OpenGL's own convention: row 0 of the viewport is the top row, and nothing
            # is flipped.
            [0.0, scale_y * fy, scale_y * (cy + 0.5 - area.y) - 1.0, 0.0],
            [0.0, 0.0, depth, -2.0 * FAR_M * NEAR_M / (FAR_M - NEAR_M)],
            # w = +z: OpenCV's camera looks along +z, OpenGL's along −z.
            [0.0, 0.0, 1.0, 0.0],
        ]
    )


def project(points: Array, matrix: Array) -> Array:
    """Return the pixels (…, 2) of points (…, 3) in the camera frame."""
    return np.asarray((points / points[..., 2:]) @ matrix[:2].T)


def bounding_rectangle(
    points: Array, matrix: Array, camera_from_points: Array, size: tuple[int, int]
) -> Rectangle | None:
    """Return the area of a picture of a `size` (width, height) [px] around points (n, 3) [m].

    It has a margin of `MARGIN_PX` and `RELATIVE_MARGIN`. It is the whole picture if some points are
    behind the camera, and None if no point is in the picture.
    """
    # One row for each coordinate: numpy takes several times as long over short rows.
    in_camera = camera_from_points[:3, :3] @ points.T + camera_from_points[:3, 3:]
    if not len(points) or in_camera[2].max() < NEAR_M:
        return None
    # A point behind the camera projects to the wrong side; no rectangle can be told then.
    if in_camera[2].min() < NEAR_M:
        return Rectangle(0, 0, *size)
    pixels = matrix[:2] @ (in_camera / in_camera[2])
    ranges = []
    for low, high, side in zip(
        pixels.min(axis=1).tolist(), pixels.max(axis=1).tolist(), size, strict=True
    ):
        rim = MARGIN_PX + RELATIVE_MARGIN * (high - low)
        first = min(max(math.floor(low - rim), 0), side)
        # + 1: the end is exclusive, and a pixel reaches half beyond its centre.
        ranges.append((first, min(max(math.ceil(high + rim) + 1, 0), side) - first))
    (x, width), (y, height) = ranges
    return Rectangle(x, y, width, height) if min(width, height) > 0 else None


def texture_size(width: int, height: int) -> tuple[int, int]:
    """Return a size that is rounded up to multiples of `SIZE_STEP_PX`.

    >>> texture_size(1, 65)
    (64, 128)
    """
    return -(-width // SIZE_STEP_PX) * SIZE_STEP_PX, -(-height // SIZE_STEP_PX) * SIZE_STEP_PX


def grown_size(kept: tuple[int, int] | None, needed: tuple[int, int]) -> tuple[int, int] | None:
    """Return the size of the texture that must replace a kept one, which never shrinks.

    It is None if the kept one is large enough.

    >>> grown_size((128, 64), (100, 80)), grown_size((128, 64), (100, 60))
    ((128, 128), None)
    """
    if kept is None:
        return texture_size(*needed)
    if kept[0] >= needed[0] and kept[1] >= needed[1]:
        return None
    return texture_size(max(kept[0], needed[0]), max(kept[1], needed[1]))


def is_invertible(transform: Array | None) -> bool:
    """Return whether a transform is a finite, non-singular (4, 4) matrix; it may be scaled."""
    if transform is None or np.shape(transform) != (4, 4) or not np.isfinite(transform).all():
        return False
    # Plain numbers: for one matrix, the functions of numpy take ten times as long.
    (a, b, c), (d, e, f), (g, h, i) = np.asarray(transform, float)[:3, :3].tolist()
    determinant = a * (e * i - f * h) - b * (d * i - f * g) + c * (d * h - e * g)
    # Relative to the axes' lengths: a model in millimetres stands on the table at a scale of 1e-4.
    volume = math.hypot(a, d, g) * math.hypot(b, e, h) * math.hypot(c, f, i)
    return bool(abs(determinant) > MIN_RELATIVE_VOLUME * volume)


def is_pinhole(matrix: Array) -> bool:
    """Return whether a matrix is a camera's: (3, 3), finite, with positive focal lengths."""
    if np.shape(matrix) != (3, 3) or not np.isfinite(matrix).all():
        return False
    return bool(matrix[0, 0] > 0.0 and matrix[1, 1] > 0.0)


def usable_distortion(distortion: Array) -> Array:
    """Return distortion coefficients, or those of an ideal lens for a count that none has."""
    flat = np.asarray(distortion, float).ravel()
    known = flat.size in (4, 5, 8, 12, 14) and np.isfinite(flat).all()
    return flat if known else np.zeros(5)
