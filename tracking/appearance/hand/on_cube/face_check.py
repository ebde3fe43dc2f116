"""Which pixels of the cube's faces do not look like their print: a finger."""

import cv2
import numpy as np

from cubeling.tracking.appearance.hand.on_cube.face_pattern import SeenPattern
from cubeling.tracking.appearance.hand.structuring_elements import SQUARE_2, SQUARE_3
from cubeling.tracking.geometry.arrays import Flags, Floats, Image
from cubeling.tracking.geometry.robust_statistics import quantile

MIN_SHADE, MAX_SHADE = 0.62, 1.15
"""L + 16 of a part of a face relative to that of most of it: less is no shadow."""

CHROMA_TOLERANCE = 7.0
"""How far the chroma of paper and ink may be off that of the paper [CIELab]."""

INK_TOLERANCE, MAX_INK_CHROMA, DARK = 9.0, 18.0, 151.0
"""The same for ink and its own chroma; the most chroma that ink has [CIELab]; and L + 16
below which it is learned, in bytes."""

LIGHTNESS_TOLERANCE = 22.0
"""How far grey may be off what the print allows [CIELab bytes, 0…255]."""

NO_INK, ALL_INK = 26, 229
"""Share of ink, of 255, below and above which a pixel and its neighbours are paper or ink."""

MIN_EVIDENCE_EDGES2 = 0.007
"""Least area of a face that must disagree with its print [square edges]."""

LEARNING_FRAMES, TINT_STEP = 4, 0.2
"""Frames of which one tells the tint of paper and ink, and its share in what is learned."""

USUAL_BLACK, MAX_BLACK, BLACK_RANGE = 0.37, 0.66, 1.3
"""L + 16 of ink relative to paper, at first, the most of it, and the most on a face that shines
relative to the face that does least."""

MIN_PIXELS = 8
"""Pixels that a level must rest on."""

MIN_CHROMA_OFF = 1.5
"""Least difference in chroma of hand and print by which a pixel is told to be one or the other
[CIELab]."""

MAX_PRINT_SHARE, MIN_HAND_SHARE = 0.4, 0.6
"""Share of that difference up to which a pixel is print, and from which on it is the hand; between
them, it is not told."""

NEAR, MIN_SPREAD, MIN_CONTRAST = (7, 7), 0.03, 0.45
"""A square in which print is looked for [px], the least variance of the share of ink in it that
can tell, and how much darker ink must be than paper there, as a share of the mean light."""


class FaceCheck:
    """Compares faces with their print; learns the tint of the light on paper."""

    def __init__(self) -> None:
        self._tint: Floats | None = None
        self._ink: Floats | None = None
        self._black = USUAL_BLACK
        self._frames = 0

    def disagreement(self, lab: Floats, seen: SeenPattern, like_hand: Flags, edge: float) -> Flags:
        """Return which pixels do not look like the print, as far as they are connected, (h, w).

        Parameters
        ----------
        lab
            L + 16, a and b of CIELab of the cube's part of the image, in bytes, (3, h, w).
        seen
            The print there.
        like_hand
            Pixels there in the colours of the hand, as far as they are known.
        edge
            Apparent edge of the cube [px].
        """
        light, a, b = lab
        most, least = cv2.dilate(seen.ink, SQUARE_3), cv2.erode(seen.ink, SQUARE_3)
        cube = np.asarray(seen.face > 0, np.uint8)
        inner, plain = cv2.erode(cube, SQUARE_3) > 0, ~seen.icon
        no_ink, all_ink = most < NO_INK, inner & (least > ALL_INK)
        all_paper = inner & no_ink & plain
        if self._frames % LEARNING_FRAMES == 0:
            visible = _visible(light, seen.ink)
            self._tint = _update_tint(self._tint, lab[1:] / light, all_paper & visible)
            # On photographs, ink is often bluish.
            inks = lab[1:].clip(-MAX_INK_CHROMA, MAX_INK_CHROMA)
            self._ink = _update_tint(self._ink, inks, all_ink & (light < DARK) & visible)
        if self._tint is None:
            return np.zeros(cube.shape, bool)
        self._frames += 1
        coloured = _off(a - light * self._tint[0], b - light * self._tint[1], CHROMA_TOLERANCE)
        coloured &= plain
        ink = np.zeros(2, np.float32) if self._ink is None else self._ink
        coloured &= no_ink | _off(a - ink[0], b - ink[1], INK_TOLERANCE)
        paper = all_paper & ~coloured
        white, contrast = self._levels(light, seen, paper, all_ink & ~coloured)
        found = light > MAX_SHADE * (white - contrast * least) + LIGHTNESS_TOLERANCE
        found |= light < MIN_SHADE * (white - contrast * most) - 0.5 * LIGHTNESS_TOLERANCE
        found = (found | coloured) & inner
        opened = cv2.morphologyEx(found.view(np.uint8), cv2.MORPH_OPEN, SQUARE_2)
        return _from_outside(np.asarray(opened), like_hand, cube, edge * edge)

    def split_by_chroma(
        self, lab: Floats, seen: SeenPattern, evidence: Flags, doubtful: Flags
    ) -> tuple[Flags, Flags]:
        """Return which doubtful pixels are the hand, and which are print, (h, w) each.

        Dark skin is as dark as ink. But its chroma is another one, and differs from that of the
        print as it does where the hand is sure, which is `evidence`.
        """
        none = np.zeros(doubtful.shape, bool)
        if self._tint is None or self._ink is None or not doubtful.any():
            return none, none
        if np.count_nonzero(evidence) < MIN_PIXELS:
            return none, none
        ink = seen.ink * np.float32(1 / 255)
        paper = lab[0] * (np.float32(1) - ink)
        a, b = (
            cv2.blur(chroma - paper * tint - ink * of_ink, (3, 3))
            for chroma, tint, of_ink in zip(lab[1:], self._tint, self._ink, strict=True)
        )
        hand_a, hand_b = (quantile(off[evidence], 0.5) for off in (a, b))
        square = hand_a * hand_a + hand_b * hand_b
        if square < MIN_CHROMA_OFF**2:
            return none, none
        share = (a * hand_a + b * hand_b) / square
        plain = doubtful & ~seen.icon
        return plain & (share > MIN_HAND_SHARE), plain & (share < MAX_PRINT_SHARE)

    def _levels(
        self, light: Floats, seen: SeenPattern, paper: Flags, ink: Flags
    ) -> tuple[Floats, Floats]:
        """Return L + 16 of paper on the face of each pixel, and how much darker ink is, a 255th.

        They are not numbers, so that nothing is too bright or too dark, where no paper is seen.
        """
        whites: dict[int, float] = {}
        blacks: dict[int, float] = {}
        for number in seen.numbers:
            this = seen.face == number
            plain, dark = light[paper & this], light[ink & this]
            if len(plain) >= MIN_PIXELS:
                whites[number] = quantile(plain, 0.7)
                if len(dark) >= MIN_PIXELS:
                    blacks[number] = quantile(dark, 0.3) / whites[number]
        if blacks:
            self._black += TINT_STEP * (min(*blacks.values(), MAX_BLACK) - self._black)
        levels = np.full((2, 256), np.nan, np.float32)
        for number, white in whites.items():
            black = min(blacks.get(number, self._black), BLACK_RANGE * self._black)
            levels[:, number] = white, white * (1 - black) / 255
        return levels[0].take(seen.face), levels[1].take(seen.face)


def _off(a: Floats, b: Floats, tolerance: float) -> Flags:
    """Return where a chroma is larger than a tolerance."""
    return np.asarray(a * a + b * b > tolerance**2)


def _update_tint(known: Floats | None, chroma: Floats, where: Flags) -> Floats | None:
    """Return what is known of the chroma of paper or ink, (2,), after one more look at it.

    `chroma` is a and b, (2, h, w). Too few pixels change nothing.
    """
    if np.count_nonzero(where) < 4 * MIN_PIXELS:
        return known
    now = np.array([quantile(plane[where], 0.5) for plane in chroma], np.float32)
    return now if known is None else np.asarray(known + TINT_STEP * (now - known))


def _visible(light: Floats, ink: Image) -> Flags:
    """Return where the print is seen: there, ink is darker than the paper beside it, (h, w)."""
    share = ink * np.float32(1 / 255)
    mean_light, mean_ink = cv2.blur(light, NEAR), cv2.blur(share, NEAR)
    falls = mean_light * mean_ink - cv2.blur(light * share, NEAR)
    spread = cv2.blur(share * share, NEAR) - mean_ink * mean_ink
    return np.asarray((spread > MIN_SPREAD) & (falls > MIN_CONTRAST * spread * mean_light))


def _from_outside(flags: Image, like_hand: Flags, cube: Image, square: float) -> Flags:
    """Return the components large enough that reach the outline: a hand comes from there.

    What looks like hand and like print may be between; `square` is that of the edge [px²].
    """
    found = flags > 0
    if not found.any():
        return found
    rim = cv2.erode(cube, SQUARE_3, iterations=3) == 0
    through = found | like_hand
    count, labels = cv2.connectedComponents(through.view(np.uint8))
    keep = np.bincount(labels[found], minlength=count) >= MIN_EVIDENCE_EDGES2 * square
    keep &= np.bincount(labels[through & rim], minlength=count) > 0
    keep[0] = False
    return np.asarray(found & keep[labels])
