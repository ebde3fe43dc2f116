"""The colours of the hand and of what is behind it, learned over frames."""

from collections.abc import Sequence

import cv2
import numpy as np

from tracking.geometry.arrays import Array, Flags, Floats, Image, Indices

LIGHTNESS_BINS, CHROMA_BINS = 8, 24
"""Bins along L, and along each of a and b, of CIELab."""

CHROMA_STEP = 4
"""Width of a bin along a and b [CIELab]: chroma tells skin, lightness varies with the light."""

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

_LEVELS = np.arange(256)
_CHROMA = np.clip((_LEVELS - 128) // CHROMA_STEP + CHROMA_BINS // 2, 0, CHROMA_BINS - 1)
_PARTS = [
    np.asarray(part, np.intp)
    for part in (
        _LEVELS * LIGHTNESS_BINS // 256 * CHROMA_BINS**2,
        _CHROMA * CHROMA_BINS,
        _CHROMA,
    )
]
"""What L, a and b of CIELab, bytes, add to the number of a bin."""


def colour_bins(planes: Sequence[Image]) -> Indices:
    """Return the bin of each pixel of CIELab planes of bytes, (h, w) each → (h, w)."""
    bins = np.take(_PARTS[0], planes[0])
    bins += np.take(_PARTS[1], planes[1])
    bins += np.take(_PARTS[2], planes[2])
    return np.asarray(bins)


class ColourModel:
    """Two histograms that forget slowly: of the hand, and of what is behind it."""

    def __init__(self) -> None:
        bins = LIGHTNESS_BINS * CHROMA_BINS**2
        self._hand, self._behind = np.zeros(bins), np.zeros(bins)
        self._hand_density: Floats | None = None

    @property
    def knows_hand(self) -> bool:
        """Whether enough of a hand was seen."""
        return bool(self._hand.sum() > MIN_LEARNED)

    @property
    def knows_behind(self) -> bool:
        """Whether anything behind the hand was seen."""
        return bool(self._behind.any())

    def learn_hand(self, bins: Indices, where: Flags) -> None:
        """Add the marked pixels to the hand's colours."""
        self._hand = _learned(self._hand, bins[where])
        self._hand_density = None

    def learn_behind(self, bins: Indices, where: Flags) -> None:
        """Add the marked pixels to the colours behind the hand."""
        self._behind = _learned(self._behind, bins[where])

    def odds(self) -> Floats:
        """Return what the colour of each bin speaks for a hand, as the logarithm of odds."""
        if not self.knows_hand:
            return np.zeros(len(self._hand), np.float32)
        if self._hand_density is None:
            self._hand_density = _density(self._hand)
        ratio = np.log((self._hand_density + MIN_DENSITY) / (_density(self._behind) + MIN_DENSITY))
        return np.asarray(np.clip(ratio, -MAX_ODDS, MAX_ODDS), np.float32)


def _learned(counts: Array, bins: Indices) -> Array:
    return np.asarray(counts * MEMORY_PER_FRAME + np.bincount(bins, minlength=len(counts)))


def _density(counts: Array) -> Floats:
    """Return the share of each colour, smoothed over neighbouring bins."""
    flat = counts.reshape(LIGHTNESS_BINS, CHROMA_BINS**2).astype(np.float32)
    grid = np.asarray(cv2.blur(flat, (1, 3)), np.float32).reshape(-1, CHROMA_BINS, CHROMA_BINS)
    soft = cv2.GaussianBlur(np.ascontiguousarray(grid.transpose(1, 2, 0)), (3, 3), 0.8)
    shares = np.asarray(soft, np.float32).transpose(2, 0, 1).ravel()
    return np.asarray(shares / max(float(shares.sum()), 1.0), np.float32)
