"""Captions of the pictures of the documents."""

import math

import cv2
import numpy as np
from numpy.typing import NDArray

from cubeling.characters.rendering.portrait import PAPER_BGR

Image = NDArray[np.uint8]

FONT, SCALE = cv2.FONT_HERSHEY_SIMPLEX, 0.62
"""Font of the captions, and its size."""


def framed(picture: Image, text: str) -> Image:
    """Return a picture with a caption in the middle below it, and a white rim."""
    height, width = picture.shape[:2]
    page = np.full((height + 44, width + 8, 3), 255, np.uint8)
    page[4 : height + 4, 4 : width + 4] = picture
    (length, _), _ = cv2.getTextSize(text, FONT, SCALE, 1)
    at = (math.ceil((width - length) / 2), height + 30)
    cv2.putText(page, text, at, FONT, SCALE, (70, 60, 60), 1, cv2.LINE_AA)
    return page


def underlined(picture: Image, text: str, band_px: int, scale: float) -> Image:
    """Return a portrait with a small caption on a band of its own paper below it."""
    band = np.full((band_px, picture.shape[1], 3), PAPER_BGR, np.uint8)
    cv2.putText(band, text, (4, band_px - 4), FONT, scale, (60, 50, 40), 1, cv2.LINE_AA)
    return np.vstack([picture, band])
