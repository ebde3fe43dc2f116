"""The soft edge of the hand: how much of each pixel it covers."""

import cv2
import numpy as np

from tracking.appearance.window import Window
from tracking.geometry.arrays import Floats, Image

ODDS_RANGE = 2.0
"""Logarithm of odds, positive or negative, beyond which nothing is surer: where the edge is depends
on what is hand and what is not, and not on how sure that is."""

MIN_CONTRAST, CONTRAST_WEIGHT = 15.0, 0.6
"""Least difference of hand and desk by which the share is measured [CIELab bytes]; and the weight
of that, beside the share by odds."""

EDGE_LEVELS = 90.0
"""Range of shares, whose whole range is 255, over which the cover rises from 0 to 255: pixels of
the window are larger than those of the image."""

COVER = np.clip((np.arange(256) - 128) * (255 / EDGE_LEVELS) + 128, 0, 255).astype(np.uint8)
"""Cover for the share at full resolution."""

SMALL, WIDE = np.ones((3, 3), np.uint8), np.ones((5, 5), np.uint8)
"""A pixel with its neighbours."""


def soft_cover(
    hand: Image, odds: Floats, difference: Floats, window: Window
) -> tuple[int, int, Image]:
    """Return the cover of the pixels of the image, 0…255, after its first column and row.

    A pixel at the edge mixes hand and desk: it differs by a share of what a whole one does.

    Parameters
    ----------
    hand
        Where the hand is, (h, w).
    odds
        What speaks for it, (h, w).
    difference
        How much the picture differs from the desk, (h, w) [CIELab bytes].
    window
        Where that is in the image.
    """
    left, top, width, height = cv2.boundingRect(hand)
    left, right = max(left - 2, 0), min(left + width + 2, window.width)
    top, bottom = max(top - 2, 0), min(top + height + 2, window.height)
    part = np.s_[top:bottom, left:right]
    core, near = (np.asarray(of(hand[part], SMALL), np.uint8) for of in (cv2.erode, cv2.dilate))
    share = odds[part] * np.float32(0.5 / ODDS_RANGE) + np.float32(0.5)
    difference = difference[part]
    least, most = (cv2.erode(difference, WIDE), cv2.dilate(difference, WIDE))
    contrast = most - least
    weight = np.float32(CONTRAST_WEIGHT) * ((difference > 0) & (contrast > MIN_CONTRAST))
    share += weight * ((difference - least) / np.maximum(contrast, 1) - share)
    level = cv2.convertScaleAbs(np.maximum(np.maximum(share, 0) * near, core), None, 255)
    size = ((right - left) * window.scale, (bottom - top) * window.scale)
    large = cv2.resize(level, size, interpolation=cv2.INTER_LINEAR)
    x, y = (window.left + left) * window.scale, (window.top + top) * window.scale
    return x, y, np.asarray(cv2.LUT(large, COVER), np.uint8)
