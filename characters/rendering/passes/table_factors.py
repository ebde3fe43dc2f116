"""The light that is left on the table, multiplied into the picture.

This is done in memory: a software driver takes several times as long for it as OpenCV does.
"""

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from characters.rendering.haze import darkened
from characters.rendering.hidden_table import hidden_table
from characters.rendering.projection import Rectangle
from characters.rendering.resources import FrameResources
from characters.rendering.scene import Cover
from characters.skeleton.pose import Array

UNSEEN_LEVEL = 254
"""Least factor, of 255, that is not seen where a shadow ends."""


@dataclass(frozen=True)
class TableFactors:
    """What is left of all light on a part of the table; elsewhere, it is all left."""

    bgr: NDArray[np.uint8]
    """Factor of sRGB values in each texel, 255 for 1, (rows along z, columns along x, 3)."""

    corner: tuple[float, float]
    """Lowest x and z of the part [m]."""

    texel: float
    """Side of a texel [m]."""

    def cropped(self) -> "TableFactors":
        """Return the part that is seen to be dark, and one texel around it."""
        seen = cv2.inRange(self.bgr, (UNSEEN_LEVEL,) * 3, (255,) * 3)
        x, y, width, height = cv2.boundingRect(cv2.bitwise_not(seen))
        left, top = max(x - 1, 0), max(y - 1, 0)
        part = self.bgr[top : y + height + 1, left : x + width + 1] if width else self.bgr[:0]
        corner = self.corner[0] + left * self.texel, self.corner[1] + top * self.texel
        return TableFactors(np.ascontiguousarray(part), corner, self.texel)

    @property
    def corners(self) -> Array:
        """The corners of the part in the table frame, (4, 3) [m]."""
        (x, z), (rows, columns) = self.corner, self.bgr.shape[:2]
        right, far = x + columns * self.texel, z + rows * self.texel
        return np.array([(x, 0.0, z), (right, 0.0, z), (right, 0.0, far), (x, 0.0, far)])

    @property
    def table_from_texel(self) -> Array:
        """The map from column and row of a texel to x and z on the table, (3, 3)."""
        x, z = (edge + 0.5 * self.texel for edge in self.corner)
        return np.array([(self.texel, 0.0, x), (0.0, self.texel, z), (0.0, 0.0, 1.0)])


def darken(frame: FrameResources, cover: Cover | None, factors: TableFactors) -> None:
    """Multiply the table in the picture of a frame, except where real cubes or a hand hide it."""
    factors = factors.cropped()
    area = frame.area_of(factors.corners) if factors.bgr.size else None
    if area is None:
        return
    left = _in_picture(frame, factors, area)
    hidden = hidden_table(frame.hidden_by_cubes, cover, area)
    if hidden is not None and hidden.any():
        x, y, width, height = cv2.boundingRect(hidden)
        box = np.s_[y : y + height, x : x + width]
        seen = cv2.cvtColor(cv2.bitwise_not(hidden[box]), cv2.COLOR_GRAY2BGR)
        taken = cv2.multiply(cv2.bitwise_not(left[box]), seen, scale=1 / 255)
        left[box] = cv2.bitwise_not(taken)
    part = frame.picture[area.slices]
    part[:] = darkened(part, left, frame.haze)


def _in_picture(frame: FrameResources, factors: TableFactors, area: Rectangle) -> NDArray[np.uint8]:
    """Return the factors in the pixels of an area, (height, width, 3)."""
    shift = np.array([(1.0, 0.0, -area.x), (0.0, 1.0, -area.y), (0.0, 0.0, 1.0)])
    pixel_from_table = shift @ frame.camera_matrix @ frame.camera_from_table[:3, [0, 2, 3]]
    pixel_from_texel = pixel_from_table @ factors.table_from_texel
    size = area.width, area.height
    # OpenCV takes half as long for four channels as for three.
    bgra = cv2.cvtColor(factors.bgr, cv2.COLOR_BGR2BGRA)
    white = (255.0,) * 4
    bent = cv2.warpPerspective(
        bgra, pixel_from_texel, size, None, cv2.INTER_LINEAR, cv2.BORDER_CONSTANT, white
    )
    left = np.asarray(cv2.cvtColor(bent, cv2.COLOR_BGRA2BGR), np.uint8)
    # A pixel above the horizon shows no table: its ray meets it behind the camera.
    depth_row = np.linalg.inv(pixel_from_table)[2]
    corners = np.array([(x, y, 1.0) for x in (0, area.width) for y in (0, area.height)])
    if (corners @ depth_row <= 0.0).any():
        x, y = np.arange(area.width), np.arange(area.height)[:, None]
        left[depth_row[0] * x + depth_row[1] * y + depth_row[2] <= 0.0] = 255
    return left
