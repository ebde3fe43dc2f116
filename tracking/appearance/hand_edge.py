"""The soft edge of the hand: how much of each pixel it covers."""

import cv2
import numpy as np

from tracking.appearance.background import Place
from tracking.appearance.window import Window
from tracking.geometry.arrays import Flags, Floats, Image

ODDS_RANGE = 4.0
"""Logarithm of odds, positive or negative, beyond which nothing is surer."""

EDGE_ODDS = 0.8
"""Odds at which half of a pixel is covered: what differs from the desk is smoothed, so it grows."""

MATTE_WEIGHT, MATTE_SHIFT = 0.75, 0.1
"""Weight of the share by colours, beside that by odds; and what of it is the hand's own shadow."""

MIN_CONTRAST = 25.0
"""Least difference of hand and desk by which the share is measured [CIELab bytes]."""

MIN_GAIN, MAX_GAIN = 0.4, 1.5
"""Least and most light on the desk beside the hand, relative to before."""

EDGE_LEVELS = 90.0
"""Range of shares, whose whole range is 255, over which the cover rises from 0 to 255: pixels of
the window are larger than those of the image."""

COVER = np.clip((np.arange(256) - 128) * (255 / EDGE_LEVELS) + 128, 0, 255).astype(np.uint8)
"""Cover for the share at full resolution."""

SMALL = np.ones((3, 3), np.uint8)
"""A pixel with its neighbours."""

NEAR_PX = (5, 5)
"""Square in which the colours of hand and desk are measured [px of the window]."""

NOTHING = np.float32(1e-3)
"""What is added to sums that may be zero."""


def soft_cover(hand: Image, odds: Floats, window: Window, place: Place) -> tuple[int, int, Image]:
    """Return the cover of the pixels of the image, 0…255, after its first column and row.

    Parameters
    ----------
    hand
        Where the hand is, (h, w).
    odds
        What speaks for it, (h, w).
    window, place
        Where that is in the image, and how it looks compared with the desk.
    """
    left, top, width, height = cv2.boundingRect(hand)
    left, right = max(left - 2, 0), min(left + width + 2, window.width)
    top, bottom = max(top - 2, 0), min(top + height + 2, window.height)
    part = np.s_[top:bottom, left:right]
    core, near = (np.asarray(of(hand[part], SMALL), np.uint8) for of in (cv2.erode, cv2.dilate))
    share = (odds[part] - np.float32(EDGE_ODDS)) * np.float32(0.5 / ODDS_RANGE) + np.float32(0.5)
    share = np.minimum(np.maximum(share, 0), 1)
    matte, matted = _matte(place.part(part), core, near)
    weight = np.float32(MATTE_WEIGHT) * matted
    share += weight * (matte - np.float32(MATTE_SHIFT) - share)
    level = cv2.convertScaleAbs(np.maximum(np.maximum(share, 0) * near, core), None, 255)
    size = ((right - left) * window.scale, (bottom - top) * window.scale)
    large = cv2.resize(level, size, interpolation=cv2.INTER_LINEAR)
    x, y = (window.left + left) * window.scale, (window.top + top) * window.scale
    return x, y, np.asarray(cv2.LUT(large, COVER), np.uint8)


def _matte(place: Place, core: Image, near: Image) -> tuple[Floats, Flags]:
    """Return the hand's share of each pixel's colour, (h, w), and where that could be measured.

    A pixel at the edge mixes the colour of the hand inside of it (`core`) with that of the desk,
    in the light that falls on the desk outside of it (not `near`): the hand shades it.
    """
    inside, known = core.astype(np.float32), place.known
    outside = ((near == 0) & known).astype(np.float32)
    lights = (
        cv2.blur(planes[0] * outside, NEAR_PX) for planes in (place.picture, place.background)
    )
    now, before = (light + NOTHING for light in lights)
    gain = np.minimum(np.maximum(now / before, MIN_GAIN), MAX_GAIN)
    weight = 1 / (cv2.blur(inside, NEAR_PX) + NOTHING)
    along, square = np.zeros_like(inside), np.zeros_like(inside)
    for seen, desk in zip(place.picture, gain * place.background, strict=True):
        contrast = cv2.blur(seen * inside, NEAR_PX) * weight - desk
        along += (seen - desk) * contrast
        square += contrast * contrast
    matted = known & (square > MIN_CONTRAST**2) & (weight < 1 / (2 * NOTHING))
    return np.minimum(along / np.maximum(square, 1), 1), matted
