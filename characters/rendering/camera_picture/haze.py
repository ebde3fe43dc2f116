"""The glare of lens and air that lies over a camera's picture, on what is drawn."""

import cv2
import numpy as np
from numpy.typing import NDArray

from cubeling.characters.rendering.camera_picture.light import LINEAR_FROM_SRGB

Image = NDArray[np.uint8]

MIN_HAZE = 0.0005
"""Less haze than this changes no value of a picture by more than two."""


def haze_table(haze: float, paper: float) -> Image | None:
    """Return what each sRGB value becomes in a hazy picture, (256,), or None in a clear one.

    `haze` and `paper` are those of `Softness`.

    >>> haze_table(0.1, 1.0)[[0, 100, 255]].tolist()
    [89, 128, 255]
    >>> haze_table(0.0, 1.0)
    """
    if haze < MIN_HAZE:
        return None
    light = haze * paper + (1.0 - haze) * LINEAR_FROM_SRGB
    return np.asarray(np.rint(np.interp(light, LINEAR_FROM_SRGB, np.arange(256.0))), np.uint8)


def hazy(pixels: Image, table: Image) -> Image:
    """Return pixels (height, width, 4), their colours times their shares, through a table."""
    # OpenCV takes several times as long for channels that are not all next to each other, and
    # numpy for masks of all pixels.
    color, share = cv2.cvtColor(pixels, cv2.COLOR_BGRA2BGR), cv2.extractChannel(pixels, 3)
    seen = cv2.cvtColor(cv2.inRange(share, 1, 255), cv2.COLOR_GRAY2BGR)
    looked_up = cv2.min(cv2.LUT(color, table), seen)
    partly = np.flatnonzero(cv2.inRange(share, 1, 254))
    part = share.ravel()[partly, None] / 255.0
    own = np.rint(color.reshape(-1, 3)[partly] / part).clip(0, 255).astype(np.uint8)
    looked_up.reshape(-1, 3)[partly] = np.rint(table[own] * part)
    result = cv2.cvtColor(looked_up, cv2.COLOR_BGR2BGRA)
    cv2.insertChannel(share, result, 3)
    return np.asarray(result, np.uint8)


def darken_picture(picture: Image, left: Image, table: Image | None) -> Image:
    """Return a picture (height, width, 3) times the shares that are left of its light, 255 for 1.

    The glare in it is not shaded: nothing becomes darker than that.
    """
    shaded = cv2.multiply(picture, left, scale=1 / 255)
    if table is not None:
        glare = cv2.multiply(cv2.bitwise_not(left), np.full(4, table[0] / 255.0))
        shaded = cv2.min(cv2.add(shaded, glare), picture)
    return np.asarray(shaded, np.uint8)
