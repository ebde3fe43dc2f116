"""What a hand covers of the picture."""

from dataclasses import dataclass, replace
from functools import lru_cache

import cv2
import numpy as np
from numpy.typing import NDArray

from cubeling.characters.rendering.projection import Rectangle
from cubeling.characters.rendering.scene import Cover
from cubeling.characters.skeleton.pose import Array

Maps = tuple[NDArray[np.float32], NDArray[np.float32]]
"""Columns and rows of the frame at each pixel of the picture, (height, width) each [px]."""


@dataclass(frozen=True)
class PictureCover:
    """A cover of the camera's frame, in the picture: only what is asked for is worked out."""

    area: Rectangle
    """The area of the picture with all of it; it has an empty rim, so that it ends softly."""

    cover: Cover
    """The cover in the frame."""

    maps: Maps | None
    """From the picture to the frame; None where they are the same."""

    @property
    def behind(self) -> Array:
        """A point behind it, as in `Cover`."""
        return self.cover.behind

    def share_in(self, area: Rectangle) -> NDArray[np.uint8]:
        """Return the share of each pixel of an area that is covered, (height, width), 0…255."""
        scale = self.cover.scale
        x, y = (corner + 0.5 * (scale - 1) for corner in (self.cover.x, self.cover.y))
        if self.maps is None:
            # In a fifth of the time that `cv2.remap` takes.
            pixel_from_square = np.array([(scale, 0.0, x - area.x), (0.0, scale, y - area.y)])
            size = area.width, area.height
            found = cv2.warpAffine(self.cover.share, pixel_from_square, size)
        else:
            columns, rows = (each[area.slices] for each in self.maps)
            found = cv2.remap(
                self.cover.share,
                (columns - np.float32(x)) * np.float32(1 / scale),
                (rows - np.float32(y)) * np.float32(1 / scale),
                cv2.INTER_LINEAR,
            )
        if self.cover.slope != 1.0:
            found = cv2.LUT(found, _steeper(self.cover.slope))
        return np.asarray(found, np.uint8)


@lru_cache(maxsize=4)
def _steeper(slope: float) -> NDArray[np.uint8]:
    """Return what each share becomes where it rises more steeply through a half, (256,)."""
    levels = (np.arange(256) - 128) * slope + 128
    return np.asarray(np.clip(levels, 0, 255), np.uint8)


def cropped(cover: Cover) -> Cover:
    """Return the part of a cover that covers anything."""
    x, y, width, height = cv2.boundingRect(cover.share) if cover.share.size else (0, 0, 0, 0)
    share = np.ascontiguousarray(cover.share[y : y + height, x : x + width])
    return replace(cover, x=cover.x + cover.scale * x, y=cover.y + cover.scale * y, share=share)
