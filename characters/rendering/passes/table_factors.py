"""The light that is left on the table, multiplied into the picture."""

import cv2
import numpy as np

from cubeling.characters.rendering.camera_picture.hand_cover import PictureCover
from cubeling.characters.rendering.camera_picture.haze import darken_picture
from cubeling.characters.rendering.camera_picture.hidden_table import hidden_table
from cubeling.characters.rendering.passes.table_image import TableImage
from cubeling.characters.rendering.resources import FrameResources

UNSEEN_LEVEL = 254
"""Least factor, of 255, that is not seen where a shadow ends."""


def darken(frame: FrameResources, cover: PictureCover | None, factors: TableImage) -> None:
    """Multiply the table in the picture of a frame, except where real cubes or a hand hide it.

    `factors` are those of sRGB values, BGR, 255 for 1; beyond them, all light is left.
    """
    dark = _crop(factors)
    area = None if dark is None else frame.area_of(dark.corners)
    if dark is None or area is None:
        return
    left = dark.in_picture(frame, area, beyond=255)
    hidden = hidden_table(frame.hidden_by_cubes, cover, area)
    if hidden is not None and hidden.any():
        x, y, width, height = cv2.boundingRect(hidden)
        box = np.s_[y : y + height, x : x + width]
        seen = cv2.cvtColor(cv2.bitwise_not(hidden[box]), cv2.COLOR_GRAY2BGR)
        taken = cv2.multiply(cv2.bitwise_not(left[box]), seen, scale=1 / 255)
        left[box] = cv2.bitwise_not(taken)
    part = frame.picture[area.slices]
    part[:] = darken_picture(part, left, frame.haze)


def _crop(factors: TableImage) -> TableImage | None:
    """Return the part that is seen to be dark, and one texel around it; None if none is."""
    seen = cv2.inRange(factors.pixels, (UNSEEN_LEVEL,) * 3, (255,) * 3)
    x, y, width, height = cv2.boundingRect(cv2.bitwise_not(seen))
    if not width:
        return None
    left, top = max(x - 1, 0), max(y - 1, 0)
    part = factors.pixels[top : y + height + 1, left : x + width + 1]
    corner = factors.corner[0] + left * factors.texel, factors.corner[1] + top * factors.texel
    return TableImage(np.ascontiguousarray(part), corner, factors.texel)
