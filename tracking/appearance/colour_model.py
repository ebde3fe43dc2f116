"""The colours of the hand and of what is behind it, learned over frames."""

from collections.abc import Sequence

import cv2
import numpy as np

from tracking.geometry.arrays import Floats, Image

LAB_BINS = (8, 24, 24)
"""Bins along L, a and b of CIELab: chroma tells skin, lightness varies with the light."""

LAB_RANGES = (0, 256, 80, 176, 80, 176)
"""First and last value, exclusive, of the bins along L, a and b [CIELab bytes]."""

LIGHTNESS_OFFSET = 41.0
"""16 of CIELab's L in bytes: light scales L + 16, and the chroma by the same factor."""

MEMORY_PER_FRAME = 0.96
"""What remains of a histogram after one more frame: half of it after 17."""

MIN_LEARNED = 40
"""Pixels of a hand from which on its colours are known."""

MIN_DENSITY = 1e-4
"""Density of a colour that was never seen."""

MAX_ODDS = 2.0
"""What a colour speaks for or against a hand at most, as the logarithm of odds."""

_ODDS_OF_BYTE = (np.arange(256, dtype=np.float32) - 128) * np.float32(MAX_ODDS / 127)

Colours = tuple[Image, Image, Image]
"""L, a and b of CIELab, bytes, (h, w) each, none beyond the bins."""


def colours(planes: Sequence[Image]) -> Colours:
    """Return planes of CIELab, with what is beyond the bins in the last of them."""
    least, most = np.uint8(LAB_RANGES[2]), np.uint8(LAB_RANGES[3] - 1)
    a, b = (np.minimum(np.maximum(plane, least), most) for plane in planes[1:])
    return planes[0], a, b


class ColourModel:
    """Two histograms that forget slowly: of the hand, and of what is behind it."""

    def __init__(self) -> None:
        self._hand, self._behind = np.zeros(LAB_BINS, np.float32), np.zeros(LAB_BINS, np.float32)
        self._hand_density: Floats | None = None

    @property
    def knows_hand(self) -> bool:
        """Whether enough of a hand was seen."""
        return bool(self._hand.sum() > MIN_LEARNED)

    @property
    def knows_behind(self) -> bool:
        """Whether anything behind the hand was seen."""
        return bool(self._behind.any())

    def learn_hand(self, seen: Colours, where: Image) -> None:
        """Add the marked pixels to those of the hand."""
        self._hand = _learned(self._hand, seen, where)
        self._hand_density = None

    def learn_behind(self, seen: Colours, where: Image) -> None:
        """Add the marked pixels to those behind the hand."""
        self._behind = _learned(self._behind, seen, where)

    def odds(self, seen: Colours) -> Floats:
        """Return what the colour of each pixel speaks for a hand, (h, w): logarithm of odds."""
        if not self.knows_hand:
            return np.zeros(seen[0].shape, np.float32)
        if self._hand_density is None:
            self._hand_density = _density(self._hand)
        ratio = np.log((self._hand_density + MIN_DENSITY) / (_density(self._behind) + MIN_DENSITY))
        table = ratio.clip(-MAX_ODDS, MAX_ODDS) * (127 / MAX_ODDS) + 128
        histogram = cv2.Mat(table)  # type: ignore[no-untyped-call]  # its last axis: no channels
        bytes_ = cv2.calcBackProject(seen, [0, 1, 2], histogram, LAB_RANGES, 1)
        return np.asarray(cv2.LUT(bytes_, _ODDS_OF_BYTE), np.float32)


def _learned(counts: Floats, seen: Colours, where: Image) -> Floats:
    new = cv2.calcHist(seen, [0, 1, 2], where, LAB_BINS, LAB_RANGES)
    return np.asarray(cv2.scaleAdd(counts, MEMORY_PER_FRAME, np.asarray(new, np.float32)))


def _density(counts: Floats) -> Floats:
    """Return the share of each colour, smoothed over neighbouring bins."""
    flat = counts.reshape(LAB_BINS[0], -1)
    grid = np.asarray(cv2.blur(flat, (1, 3)), np.float32).reshape(LAB_BINS)
    soft = cv2.GaussianBlur(np.ascontiguousarray(grid.transpose(1, 2, 0)), (3, 3), 0.8)
    shares = np.asarray(soft, np.float32).transpose(2, 0, 1)
    return np.ascontiguousarray(shares / max(float(shares.sum()), 1.0))
