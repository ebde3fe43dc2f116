"""The arm behind a hand, beyond the window in which the hand is looked for: in coarse samples."""

from dataclasses import replace

import cv2
import numpy as np

from cubeling.tracking.appearance.hand.background import GRID_PX, MIDDLES, Box
from cubeling.tracking.appearance.hand.components import components_with
from cubeling.tracking.appearance.hand.mask import HandMask
from cubeling.tracking.appearance.hand.structuring_elements import SQUARE_3
from cubeling.tracking.appearance.hand.window import HandWindow
from cubeling.tracking.geometry.arrays import Flags, Image

ARM_EDGES, ARM_UP_EDGES = 12.0, 3.0
"""How far beyond the window the arm is looked for, and how far upwards [apparent edges of the
cube]: there it goes away from the camera, and its owner sits behind all that is on the table."""

MAX_WIDTH_EDGES = 3.0
"""Most width of an arm; what is wider is a body, behind all that stands on the table [edges]."""

HALF_SHARE = 127
"""Share above which a sample is of the hand, 0…255."""

ARM_SHARE = np.uint8(225)
"""Share of a sample in the arm, 0…255: at its edge, less than half of a sample that has changed is
covered, on average."""


def arm_samples(window: HandWindow, size: tuple[int, int]) -> Box:
    """Return rows and columns of the samples in which the arm is looked for.

    Parameters
    ----------
    window
        Where the hand is looked for.
    size
        Of the image, (width, height) [px].
    """
    reach, up = (round(edges * window.edge / GRID_PX) for edges in (ARM_EDGES, ARM_UP_EDGES))
    rows, columns = (
        slice(max(side.start - before, 0), min(side.stop + reach, end // (GRID_PX * window.scale)))
        for side, before, end in zip(window.samples, (up, reach), size[::-1], strict=True)
    )
    return rows, columns


def with_arm(hand: HandMask, changed: Flags, samples: Box, window: HandWindow) -> HandMask:
    """Return what a hand covers together with its arm: what has changed and is connected to it.

    Parameters
    ----------
    hand
        What was found in a window.
    changed
        Samples that look like something else than the desk, (h, w).
    samples
        Their rows and columns.
    window
        Where the hand was looked for.
    """
    rows, columns = (
        slice(side.start - first.start, side.stop - first.start)
        for side, first in zip(window.samples, samples, strict=True)
    )
    inside = rows, columns
    share = np.zeros((window.height, window.width), np.uint8)
    top, left = hand.y // hand.scale - window.top, hand.x // hand.scale - window.left
    height, width = hand.share.shape
    share[top : top + height, left : left + width] = hand.share
    share = share[tuple(slice(GRID_PX * (side.stop - side.start)) for side in inside)]
    flags = changed.view(np.uint8).copy()
    flags[inside] = share[MIDDLES, MIDDLES] > HALF_SHARE
    arm = _arm(flags, inside, round(MAX_WIDTH_EDGES * window.edge / GRID_PX) | 1)
    part = _around(arm, inside)
    arm = ARM_SHARE * arm[part]
    soft = cv2.resize(arm, None, fx=GRID_PX, fy=GRID_PX, interpolation=cv2.INTER_LINEAR)
    # Less than a sample may be left of the image.
    soft = cv2.copyMakeBorder(soft, 0, GRID_PX - 1, 0, GRID_PX - 1, cv2.BORDER_REPLICATE)
    top, left = (
        GRID_PX * (side.start - first.start) for side, first in zip(inside, part, strict=True)
    )
    soft[top : top + share.shape[0], left : left + share.shape[1]] = share
    y, x = (
        GRID_PX * hand.scale * (side.start + first.start)
        for side, first in zip(samples, part, strict=True)
    )
    return replace(hand, x=x, y=y, share=np.asarray(soft, np.uint8))


def _around(arm: Image, inside: Box) -> Box:
    """Return rows and columns with arm and window, and one more, as an edge is interpolated."""
    x, y, width, height = cv2.boundingRect(arm)
    rows, columns = (
        slice(max(min(first, side.start) - 1, 0), max(first + count, side.stop) + 1)
        for first, count, side in zip((y, x), (height, width), inside, strict=True)
    )
    return rows, columns


def _arm(flags: Image, inside: Box, side: int) -> Image:
    """Return hand and arm: what is connected to the hand, is no speck and not as wide as a body.

    `side` is the most width of an arm, odd [samples].
    """
    for operation in (cv2.MORPH_OPEN, cv2.MORPH_CLOSE):
        flags = np.asarray(cv2.morphologyEx(flags, operation, SQUARE_3), np.uint8)
    arm = components_with(flags, inside)
    if np.count_nonzero(arm) > side**2:
        body = cv2.morphologyEx(arm, cv2.MORPH_OPEN, np.ones((side, side), np.uint8)) > 0
        body[inside] = False
        arm[body] = 0
    return arm
