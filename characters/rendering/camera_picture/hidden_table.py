"""The part of the table that real cubes or a hand hide, in the pixels of a region."""

from collections.abc import Sequence

import cv2
import numpy as np
from numpy.typing import NDArray

from cubeling.characters.rendering.camera_picture.hand_cover import PictureCover
from cubeling.characters.rendering.projection import Rectangle


def hidden_table(
    cubes: Sequence[tuple[Rectangle, NDArray[np.uint8]]],
    cover: PictureCover | None,
    area: Rectangle,
) -> NDArray[np.uint8] | None:
    """Return the share of each pixel of a region that is hidden, or None where nothing is.

    Parameters
    ----------
    cubes
        Where real cubes are in the picture, and what share of each pixel they hide.
    cover
        The hand.
    area
        The region.

    Returns
    -------
    0…255, (height, width).
    """
    hidden: NDArray[np.uint8] | None = None
    for place, share in cubes:
        shared = place.intersection(area)
        if shared is not None:
            hidden = _join(hidden, share[shared.within(place).slices], shared, area)
    shared = None if cover is None else cover.area.intersection(area)
    if cover is not None and shared is not None:
        part = cover.share_in(shared)
        hidden = _join(hidden, part, shared, area)
    return hidden


def _join(
    hidden: NDArray[np.uint8] | None, part: NDArray[np.uint8], shared: Rectangle, area: Rectangle
) -> NDArray[np.uint8]:
    """Hide a part of a region too; what two hide independently of each other is multiplied."""
    if hidden is None:
        hidden = np.zeros((area.height, area.width), np.uint8)
    inner = hidden[shared.within(area).slices]
    inner[:] = 255 - np.asarray(cv2.multiply(255 - inner, 255 - part, scale=1 / 255), np.uint8)
    return hidden
