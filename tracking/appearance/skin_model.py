"""The colours of the hand and of what is behind it, learned over frames."""

import cv2
import numpy as np

from tracking.geometry.arrays import Flags, Floats, Image

LIGHTNESS_BINS, CHROMA_BINS = 16, 32
"""Bins along L, and along each of a and b, of CIELab."""

CHROMA_STEP = 3
"""Width of a bin along a and b [CIELab]: chroma tells skin, lightness varies with the light."""

MEMORY = 0.96
"""What remains of a histogram after one frame: half of it after 17."""

FLOOR = 2e-5
"""Density of a colour that was never seen."""

Table = Floats
"""Density of each colour, (LIGHTNESS_BINS · CHROMA_BINS²,)."""


def colour_bins(lab: Image) -> np.ndarray[tuple[int, ...], np.dtype[np.int32]]:
    """Return the bin of each pixel of a CIELab image of bytes, (h, w, 3) → (h, w)."""
    return np.asarray(LIGHTNESS_PART[lab[..., 0]] + A_PART[lab[..., 1]] + B_PART[lab[..., 2]])


_levels = np.arange(256)
_chroma = np.clip((_levels - 128) // CHROMA_STEP + CHROMA_BINS // 2, 0, CHROMA_BINS - 1)
LIGHTNESS_PART = (_levels * LIGHTNESS_BINS // 256 * CHROMA_BINS**2).astype(np.int32)
A_PART = (_chroma * CHROMA_BINS).astype(np.int32)
B_PART = _chroma.astype(np.int32)


class ColourHistogram:
    """A histogram of colours that forgets slowly."""

    def __init__(self) -> None:
        self._counts = np.zeros(LIGHTNESS_BINS * CHROMA_BINS**2, np.float32)
        self.weight = 0.0
        """Number of pixels in memory."""

    def learn(self, bins: np.ndarray[tuple[int, ...], np.dtype[np.int32]], where: Flags) -> None:
        """Add the pixels that are marked."""
        found = np.bincount(bins[where], minlength=len(self._counts)).astype(np.float32)
        self._counts = self._counts * np.float32(MEMORY) + found
        self.weight = float(self._counts.sum())

    def density(self) -> Table:
        """Return the density of each colour, smoothed over neighbouring bins."""
        grid = self._counts.reshape(LIGHTNESS_BINS, CHROMA_BINS, CHROMA_BINS)
        soft = np.ascontiguousarray(grid.transpose(1, 2, 0))
        soft = cv2.GaussianBlur(soft, (5, 5), 0.9).transpose(2, 0, 1)
        padded = np.pad(soft, ((1, 1), (0, 0), (0, 0)), mode="edge")
        soft = 0.25 * padded[:-2] + 0.5 * padded[1:-1] + 0.25 * padded[2:]
        return np.asarray(soft.ravel() / max(float(soft.sum()), 1e-6), np.float32)
