"""Images that lie on the table, as the camera sees them.

They are bent in memory: a software driver takes several times as long for it as OpenCV does.
"""

import math
from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from cubeling.characters.rendering.projection import Rectangle
from cubeling.characters.rendering.resources import FrameResources
from cubeling.characters.skeleton.pose import Array


@dataclass(frozen=True)
class TableImage:
    """An image on a part of the table."""

    pixels: NDArray[np.uint8]
    """Its texels, (rows along z, columns along x), and three channels if it has colours."""

    corner: tuple[float, float]
    """Lowest x and z of the part [m]."""

    texel: float
    """Side of a texel [m]."""

    @property
    def corners(self) -> Array:
        """The corners of the part in the table frame, (4, 3) [m]."""
        (x, z), (rows, columns) = self.corner, self.pixels.shape[:2]
        right, far = x + columns * self.texel, z + rows * self.texel
        return np.array([(x, 0.0, z), (right, 0.0, z), (right, 0.0, far), (x, 0.0, far)])

    @property
    def table_from_texel(self) -> Array:
        """The map from column and row of a texel to x and z on the table, (3, 3)."""
        x, z = (edge + 0.5 * self.texel for edge in self.corner)
        return np.array([(self.texel, 0.0, x), (0.0, self.texel, z), (0.0, 0.0, 1.0)])

    def in_picture(self, frame: FrameResources, area: Rectangle, beyond: int) -> NDArray[np.uint8]:
        """Return it in the pixels of an area, (height, width, …); `beyond` is the value elsewhere.

        Above the horizon, a pixel shows no table: its ray meets it behind the camera.
        """
        shift = np.array([(1.0, 0.0, -area.x), (0.0, 1.0, -area.y), (0.0, 0.0, 1.0)])
        pixel_from_table = shift @ frame.camera_matrix @ frame.camera_from_table[:3, [0, 2, 3]]
        pixel_from_texel = pixel_from_table @ self.table_from_texel
        size = area.width, area.height
        colored = self.pixels.ndim == 3
        # OpenCV takes half as long for four channels as for three.
        texels = cv2.cvtColor(self.pixels, cv2.COLOR_BGR2BGRA) if colored else self.pixels
        edge = (float(beyond),) * 4
        bent = cv2.warpPerspective(
            texels, pixel_from_texel, size, None, cv2.INTER_LINEAR, cv2.BORDER_CONSTANT, edge
        )
        if colored:
            bent = cv2.cvtColor(bent, cv2.COLOR_BGRA2BGR)
        # One over the depth of the table is linear in column and row: a row of the inverse matrix.
        (a, b, c), (d, e, f), (g, h, i) = pixel_from_table.tolist()
        row = d * h - e * g, b * g - a * h, a * e - b * d
        sign = math.copysign(1.0, row[0] * c + row[1] * f + row[2] * i)
        across, down, first = (sign * each for each in row)
        if first + min(across * area.width, 0.0) + min(down * area.height, 0.0) <= 0.0:
            x, y = np.arange(area.width), np.arange(area.height)[:, None]
            bent[across * x + down * y + first <= 0.0] = beyond
        return np.asarray(bent, np.uint8)
