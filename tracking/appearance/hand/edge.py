"""The soft edge of the hand: how much of each pixel it covers."""

import cv2
import numpy as np

from cubeling.tracking.appearance.hand.structuring_elements import SQUARE_3, SQUARE_5
from cubeling.tracking.appearance.hand.window import HandWindow
from cubeling.tracking.geometry.arrays import Floats, Image

ODDS_RANGE = 2.0
"""Logarithm of odds, positive or negative, beyond which nothing is surer: where the edge is depends
on what is hand and what is not, and not on how sure that is."""

MIN_CONTRAST, CONTRAST_WEIGHT = 15.0, 0.6
"""Least difference of hand and desk by which the share is measured [CIELab bytes]; and the weight
of that, beside the share by odds."""


def soft_cover(
    hand: Image, odds: Floats, difference: Floats, window: HandWindow
) -> tuple[int, int, Image]:
    """Return the cover of a part of the window, 0…255, after its first column and row.

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
    core, near = (np.asarray(of(hand[part], SQUARE_3), np.uint8) for of in (cv2.erode, cv2.dilate))
    share = odds[part] * np.float32(0.5 / ODDS_RANGE) + np.float32(0.5)
    difference = difference[part]
    least, most = (cv2.erode(difference, SQUARE_5), cv2.dilate(difference, SQUARE_5))
    contrast = most - least
    weight = np.float32(CONTRAST_WEIGHT) * ((difference > 0) & (contrast > MIN_CONTRAST))
    share += weight * ((difference - least) / np.maximum(contrast, 1) - share)
    level = cv2.convertScaleAbs(np.maximum(np.maximum(share, 0) * near, core), None, 255)
    return left, top, np.asarray(level, np.uint8)
