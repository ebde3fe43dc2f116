"""What has come into the picture since it was empty, and stands on the table.

A pixel alone does not tell how far away it is. What was not there before has a foot, its lowest
pixel; there it stands, upright, and turned to the camera.
"""

from collections.abc import Iterator
from dataclasses import dataclass

import cv2
import numpy as np

from cubeling.tracking.geometry.arrays import Array, Image

MIN_DIFFERENCE = 18
"""Difference from the empty table from which on something is there, of 255 in any colour."""

MIN_AREA, MAX_THINGS = 0.002, 3
"""Area of the least thing that counts, as a share of the picture, and how many do, the largest."""

MAX_NEW = 0.4
"""Share of the picture from which on nothing came in, but the light has changed."""

SETTLING_MAPS = 60
"""What stays for so many maps belongs to the table: half a minute where much moves."""

CLOSING = np.ones((3, 3), np.uint8)


@dataclass(frozen=True)
class StandingThing:
    """Something that stands on the table."""

    pixels: Image
    """Where it is in the small picture, 255 or 0, (height, width)."""

    foot: Array
    """Column and row of its lowest pixel, (2,)."""

    corners: Array
    """Columns and rows of the corners of the rectangle around it, (4, 2)."""


class EmptyTable:
    """Remembers the table without what has come onto it."""

    def __init__(self) -> None:
        self.picture: Image = np.zeros((0, 0, 3), np.uint8)
        """The small picture without it, (height, width, 3)."""
        self._age: Image = np.zeros((0, 0), np.uint8)

    def forget(self) -> None:
        """Take the next picture for that of an empty table: the camera has moved."""
        self.picture = np.zeros((0, 0, 3), np.uint8)

    def find(self, small: Image) -> tuple[StandingThing, ...]:
        """Return what is in a small picture (height, width, 3) that was not there before."""
        if self.picture.shape != small.shape:
            self.picture, self._age = small.copy(), np.zeros(small.shape[:2], np.uint8)
            return ()
        blue, green, red = cv2.split(cv2.absdiff(small, self.picture))
        change = cv2.max(cv2.max(blue, green), red)
        _, new = cv2.threshold(change, MIN_DIFFERENCE, 255, cv2.THRESH_BINARY)
        new = cv2.morphologyEx(new, cv2.MORPH_CLOSE, CLOSING)
        if cv2.countNonZero(new) > MAX_NEW * new.size:
            new[:] = 0
        self._age = np.asarray(
            np.minimum(np.minimum(self._age, 254) + 1, new), np.uint8
        )  # that is 255 or 0
        new[self._age > SETTLING_MAPS] = 0
        cv2.copyTo(small, cv2.bitwise_not(new), self.picture)
        return tuple(_things(np.asarray(new, np.uint8)))


def _things(new: Image) -> Iterator[StandingThing]:
    """Yield the largest connected things where something is new, 255 or 0."""
    _, labels, stats, _ = cv2.connectedComponentsWithStats(new)
    order = np.argsort(-stats[1:, cv2.CC_STAT_AREA])[:MAX_THINGS] + 1
    for label in order.tolist():
        if stats[label, cv2.CC_STAT_AREA] < MIN_AREA * new.size:
            return
        x, y, width, height = stats[label, :4].tolist()
        box = np.s_[y : y + height, x : x + width]
        pixels = np.zeros_like(new)
        pixels[box] = cv2.inRange(labels[box], label, label)
        low = y + height - 1
        foot = np.array([float(np.flatnonzero(pixels[low]).mean()), float(low)])
        corners = np.array([(x, y), (x + width - 1, y), (x + width - 1, low), (x, low)], float)
        yield StandingThing(pixels, foot, corners)
