"""Which pixels of the cube's faces do not look like their print: a finger."""

import cv2
import numpy as np

from tracking.appearance.colour_model import LIGHTNESS_OFFSET
from tracking.appearance.face_pattern import SeenPattern
from tracking.geometry.arrays import Array, Flags, Floats, Image
from tracking.geometry.robust_statistics import quantile

MIN_SHADE, MAX_SHADE = 0.55, 1.25
"""Lightness of a part of a face relative to that of most of it: less is no shadow."""

CHROMA_TOLERANCE = 7.0
"""How far the chroma of paper and ink may be off that of the paper [CIELab]."""

INK_TOLERANCE, MAX_INK_CHROMA, DARK = 9.0, 18.0, 110.0
"""The same for ink and its own chroma; the most chroma that ink has [CIELab]; and the lightness
below which it is learned [CIELab bytes]."""

LIGHTNESS_TOLERANCE = 22.0
"""How far grey may be off what the print allows [CIELab bytes, 0…255]."""

MIN_EVIDENCE_EDGES2 = 0.004
"""Least area of a face that must disagree with its print [square edges]."""

TINT_STEP = 0.1
"""Share of a frame in the learned tint of paper."""

USUAL_BLACK = 0.25
"""Lightness of ink relative to paper, where no ink is seen."""

MIN_PIXELS = 8
"""Pixels that a level must rest on."""

SMALL = np.ones((3, 3), np.uint8)
"""The neighbours of a pixel."""


class FaceCheck:
    """Compares faces with their print; learns the tint of the light on paper."""

    def __init__(self) -> None:
        self._tint: Array | None = None
        self._ink = np.zeros(2)
        self._knows_ink = False

    def disagreement(self, lab: Floats, seen: SeenPattern, edge: float) -> Flags:
        """Return which pixels do not look like the print, as far as they are connected, (h, w).

        Parameters
        ----------
        lab
            CIELab of the cube's part of the image in the range of bytes, (3, h, w).
        seen
            The print there.
        edge
            Apparent edge of the cube [px].
        """
        most = np.asarray(cv2.dilate(seen.ink, SMALL), np.float32)
        least = np.asarray(cv2.erode(seen.ink, SMALL), np.float32)
        cube = np.asarray(seen.face > 0, np.uint8)
        found, inner = np.zeros(cube.shape, bool), cv2.erode(cube, SMALL) > 0
        all_paper = inner & (most < 0.1) & ~seen.icon
        if self._tint is None:
            self._tint = _first_tint(lab, all_paper)
        if self._tint is None:
            return found
        off_a = lab[1] - 128 - (lab[0] + LIGHTNESS_OFFSET) * self._tint[0]
        off_b = lab[2] - 128 - (lab[0] + LIGHTNESS_OFFSET) * self._tint[1]
        coloured = (off_a * off_a + off_b * off_b > CHROMA_TOLERANCE**2) & ~seen.icon
        dark = inner & (least > 0.9) & (lab[0] < DARK)
        self._learn_ink(lab, dark)
        off_a, off_b = lab[1] - 128 - self._ink[0], lab[2] - 128 - self._ink[1]
        coloured &= (off_a * off_a + off_b * off_b > INK_TOLERANCE**2) | (most < 0.1)
        for number in np.unique(seen.face[inner]).tolist():
            face = (seen.face == number) & inner
            found |= face & (
                coloured | _off_levels(lab[0], face & all_paper, face, most, least, coloured)
            )
        opened = cv2.morphologyEx(found.astype(np.uint8), cv2.MORPH_OPEN, SMALL[:2, :2])
        found = _from_outside(np.asarray(opened, np.uint8), cube, MIN_EVIDENCE_EDGES2 * edge * edge)
        paper = all_paper & ~coloured & ~found
        if np.count_nonzero(paper) > 4 * MIN_PIXELS:
            self._tint = self._tint + TINT_STEP * (_tint(lab, paper) - self._tint)
        return found

    def _learn_ink(self, lab: Floats, dark: Flags) -> None:
        """Learn the chroma of ink: on photographs it is often bluish."""
        if np.count_nonzero(dark) < 4 * MIN_PIXELS:
            return
        now = np.array([quantile(lab[axis][dark] - 128, 0.5) for axis in (1, 2)])
        now = np.clip(now, -MAX_INK_CHROMA, MAX_INK_CHROMA)
        self._ink = self._ink + (TINT_STEP if self._knows_ink else 1.0) * (now - self._ink)
        self._knows_ink = True


def _tint(lab: Floats, where: Flags) -> Array:
    """Chroma per L + 16 of some pixels, (2,)."""
    light = lab[0][where] + LIGHTNESS_OFFSET
    return np.array([quantile((lab[axis][where] - 128) / light, 0.5) for axis in (1, 2)])


def _first_tint(lab: Floats, paper: Flags) -> Array | None:
    """Tint of the brighter half of what should be paper."""
    if np.count_nonzero(paper) < MIN_PIXELS:
        return None
    return _tint(lab, paper & (lab[0] >= quantile(lab[0][paper], 0.5)))


def _off_levels(
    lightness: Floats, paper: Flags, face: Flags, most: Floats, least: Floats, coloured: Flags
) -> Flags:
    """Return the pixels of a face too bright for ink, or too dark for paper in a shadow."""
    plain, dark = paper & ~coloured, face & (least > 0.9) & ~coloured
    if np.count_nonzero(plain) < MIN_PIXELS:
        return np.zeros_like(face)
    white = quantile(lightness[plain], 0.7)
    black = USUAL_BLACK * white
    if np.count_nonzero(dark) >= MIN_PIXELS:
        black = min(quantile(lightness[dark], 0.3), 0.6 * white)
    top = MAX_SHADE * (white - least * (white - black)) + LIGHTNESS_TOLERANCE
    bottom = MIN_SHADE * (white - most * (white - black)) - 0.5 * LIGHTNESS_TOLERANCE
    return np.asarray((lightness > top) | (lightness < bottom))


def _from_outside(flags: Image, cube: Image, min_area: float) -> Flags:
    """Return the components large enough that reach the outline: a hand comes from there."""
    count, labels, stats, _ = cv2.connectedComponentsWithStats(flags)
    core = cv2.erode(cube, SMALL, iterations=3)
    keep = np.zeros(count, bool)
    keep[labels[(flags > 0) & (core == 0)]] = True
    keep &= stats[:, cv2.CC_STAT_AREA] >= min_area
    keep[0] = False
    return np.asarray(keep[labels])
