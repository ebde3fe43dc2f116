"""The colours of the camera's picture: linear light, and CIELab, nearly."""

import cv2
import numpy as np

from cubeling.tracking.geometry.arrays import Floats, Image

LINEAR_FROM_SRGB = np.where(
    np.arange(256) <= 10, np.arange(256) / 3294.6, ((np.arange(256) / 255 + 0.055) / 1.055) ** 2.4
)
"""Linear light of each 8-bit sRGB value (IEC 61966-2-1)."""

XYZ_FROM_BGR = np.array(
    [[0.1805, 0.3576, 0.4124], [0.0722, 0.7152, 0.2126], [0.9505, 0.1192, 0.0193]]
)
"""CIE XYZ of linear blue, green and red (IEC 61966-2-1)."""

MAX_STRAIGHT_LIGHT = (6 / 29) ** 3
"""Linear light below which CIELab takes a straight line for the cube root."""

ROOT_FROM_SRGB = np.where(
    LINEAR_FROM_SRGB > MAX_STRAIGHT_LIGHT,
    np.cbrt(LINEAR_FROM_SRGB),
    LINEAR_FROM_SRGB * ((29 / 6) ** 2 / 3) + 4 / 29,
).astype(np.float32)
"""That cube root, of each 8-bit sRGB value."""

LAB_FROM_ROOTS = (
    np.array([[0, 116 * 2.55, 0], [500, -500, 0], [0, 200, -200]])
    @ (XYZ_FROM_BGR / XYZ_FROM_BGR.sum(axis=1, keepdims=True))
).astype(np.float32)
"""L + 16, a and b from the roots of blue, green and red, as if they were those of X, Y and Z."""


def lab(image: Image, from_roots: Floats = LAB_FROM_ROOTS) -> Floats:
    """Return L + 16 of CIELab in bytes, a and b of a picture, (h, w, 3) BGR → (3, h, w), nearly.

    They are exact for grey, and a few units off for strong colours. Light scales all three by one
    factor. OpenCV's conversion takes twice the time, and rounds. Another matrix `from_roots`
    undoes what the camera has changed.
    """
    planes = np.empty((3, *image.shape[:2]), np.float32)
    cv2.split(cv2.transform(cv2.LUT(image, ROOT_FROM_SRGB), from_roots), list(planes))
    return planes
