"""What is behind the hand: a picture of the desk, learned where no hand is."""

import math
from dataclasses import dataclass, replace

import cv2
import numpy as np

from tracking.appearance.colour_model import LIGHTNESS_OFFSET
from tracking.geometry.arrays import Flags, Floats, Image
from tracking.geometry.robust_statistics import quantile

MIN_GAIN, MAX_GAIN = 0.45, 2.0
"""Least and most light on the background relative to the light before, as L + 16 of CIELab: a
shadow that comes or goes."""

MIN_CHROMA_NOISE, MIN_DETAIL_NOISE = 0.3, 0.5
"""Least deviation of chroma [CIELab], and of lightness [CIELab bytes] at one gain, that noise makes
at working resolution."""

CHROMA_LIMIT, DETAIL_LIMIT = 4.0, 2.5
"""Deviations of noise from which on a pixel is something else."""

SHADE_CHROMA, SHADE_DETAIL, EDGE_DETAIL = 10.0, 0.008, 0.05
"""How much chroma [CIELab] and detail of the gain change in a shadow, per change of the gain; and
how much of the latter at its edge."""

MAX_NOISE_RATIO = 3.0
"""Most noise that is believed, relative to the least."""

SMALL, WIDE = np.ones((3, 3), np.uint8), np.ones((9, 9), np.uint8)
"""A pixel and its neighbours."""

SPARSE = np.s_[::5, ::5]
"""Pixels by which noise and white balance are estimated."""

SAME_LIGHTNESS = 9.0
"""Change of lightness below which a pixel looks as before [CIELab bytes]."""

STEP, SHADED_STEP, CHANGED_STEP = 0.1, 0.02, 0.01
"""Share of a frame in the background, where it looks as before and where it does not: what stays
for a hundred frames belongs to it."""

UNCHANGED, CHANGED, SHADED, ROUGH, UNKNOWN = -3.0, 2.5, -1.2, 1.6, -0.4
"""What a pixel speaks for a hand, as the logarithm of odds; rough is what may be the edge of a
shadow, or skin in the colour of the desk."""

FULL_AGE = 6
"""Frames after which a pixel is known for sure."""

SELDOM_FRAMES, MAX_AGE = 3, 40
"""Frames that a pixel counts for outside the window, and how many are counted."""

MIN_KNOWN, LOST_SHARE, TRUSTED_SHARE = 0.2, 0.4, 0.6
"""Share of a window that must be known; and of that, how much must look as before to trust the
rest: less, and the camera was moved."""

MAX_ARM_SHARE = 0.5
"""Most of a part of the image that an arm covers: more, and the light or the camera changed."""

_SHADED, _CHANGED = np.uint8(254), np.uint8(255)
_STEPS = np.maximum(1 / (np.arange(256, dtype=np.float32) + 1), np.float32(STEP))
_STEPS[[_SHADED, _CHANGED]] = SHADED_STEP, CHANGED_STEP

_AGES = np.linspace(0, 1, FULL_AGE + 1, dtype=np.float32)
_NOT_TRUSTED, _TRUST = np.zeros((2, 256), np.float32)
_NOT_TRUSTED[: 4 * len(_AGES)] = UNKNOWN * np.tile(1 - _AGES, 4)
_TRUST[: 4 * len(_AGES)] = np.outer((CHANGED, ROUGH, SHADED, UNCHANGED), _AGES).ravel()
"""The odds of what changed, is rough, shaded and unchanged, each known for 0 to `FULL_AGE` frames:
what they are in any case, and what the trust in the background adds. At 255 both are 0."""

Box = tuple[slice, slice]
"""Rows and columns of a window."""


@dataclass(frozen=True)
class Place:
    """What a window of the picture is, compared with the background there."""

    odds: Floats
    """What each pixel speaks for a hand, (h, w): logarithm of odds, 0 in the cube."""

    changed: Flags
    """Pixels that look like something else, (h, w)."""

    steady: bool
    """False where so little looks as before that the camera must have moved."""

    picture: Floats
    """L + 16, a and b of CIELab of the picture, in bytes, (3, h, w)."""

    background: Floats
    """The same of the background, (3, h, w)."""

    known: Flags
    """Pixels whose background is known, (h, w)."""

    def part(self, box: Box) -> "Place":
        """Return the same of a part of the window."""
        picture, background = (
            planes[:, box[0], box[1]] for planes in (self.picture, self.background)
        )
        return replace(
            self,
            odds=self.odds[box],
            changed=self.changed[box],
            picture=picture,
            background=background,
            known=self.known[box],
        )

    def likeness(self, where: Flags) -> float:
        """Return how alike the details of picture and background are in some pixels, -1…1.

        It is the correlation, and near 0 for a hand. A textured thing that has moved by less than
        a pixel looks like something else at most pixels, and yet is much like itself.
        """
        now, before = (
            (light - cv2.blur(light, (5, 5)))[where]
            for light in (self.picture[0], self.background[0])
        )
        norm = math.sqrt(float(now @ now) * float(before @ before))
        return float(now @ before) / max(norm, 1e-6)


class Background:
    """A picture of what the camera shows without the hand, at one resolution."""

    def __init__(self) -> None:
        self._mean: Floats = np.zeros((3, 0, 0), np.float32)
        self._age: Image = np.zeros((0, 0), np.uint8)
        self._lit_anew: Flags = np.zeros((0, 0), bool)

    def match_size(self, width: int, height: int) -> None:
        """Change the resolution: it follows that in which the hand is looked for."""
        if self._age.size == 0:
            self._mean = np.ones((3, height, width), np.float32)
            self._age = np.zeros((height, width), np.uint8)
        elif self._age.shape != (height, width):
            planes = [cv2.resize(plane, (width, height)) for plane in self._mean]
            self._mean = np.stack(planes).astype(np.float32)
            # A pixel of which a neighbour is unknown is unknown.
            unknown = cv2.resize((self._age == 0).astype(np.float32), (width, height))
            age = np.asarray(cv2.resize(self._age, (width, height)), np.uint8)
            self._age = age * (unknown == 0)

    def compare(self, lab: Floats, box: Box, outside: Flags) -> Place:
        """Compare a window of the picture with the background.

        Parameters
        ----------
        lab
            L + 16, a and b of CIELab of a window, in bytes, (3, h, w).
        box
            Rows and columns of the window.
        outside
            Pixels outside the cube.
        """
        light, a, b = lab
        background, age = self._mean[:, box[0], box[1]], self._age[box]
        mean, mean_a, mean_b = background
        known = (age > 0) & outside
        some, total = known[SPARSE], np.count_nonzero(known)
        if total < max(MIN_KNOWN * np.count_nonzero(outside), 200) or not some.any():
            self._lit_anew = np.zeros(age.shape, bool)
            odds = np.float32(UNKNOWN) * outside
            return Place(odds, self._lit_anew, True, lab, background, self._lit_anew)
        gain = light / mean
        off_a, off_b = a - gain * mean_a, b - gain * mean_b
        # The camera's white balance drifts.
        off_a -= quantile(off_a[SPARSE][some], 0.5)
        off_b -= quantile(off_b[SPARSE][some], 0.5)
        # What is unknown takes part in filters as if it looked as before.
        off_a *= known
        off_b *= known
        more_light = (gain - 1) * known
        chroma = cv2.magnitude(cv2.blur(off_a, (3, 3)), cv2.blur(off_b, (3, 3)))
        # A shadow keeps the texture of what it falls on, so the gain is smooth.
        # Noise of the lightness is the same in bright and in dark places, so that of the gain not.
        rough, wide = (mean * _roughness(more_light, *each) for each in ((3, SMALL), (5, WIDE)))
        shade = np.abs(more_light)
        chroma_noise = _noise(chroma[SPARSE][some], MIN_CHROMA_NOISE)
        rough_noise = _noise(rough[SPARSE][some], MIN_DETAIL_NOISE)
        wide_noise = _noise(wide[SPARSE][some], MIN_DETAIL_NOISE)
        lit = chroma < CHROMA_LIMIT * chroma_noise + SHADE_CHROMA * shade
        detail = shade * mean
        lit &= rough < DETAIL_LIMIT * rough_noise + EDGE_DETAIL * detail
        lit &= (gain > MIN_GAIN) & (gain < MAX_GAIN)
        smooth = lit & (wide < DETAIL_LIMIT * wide_noise + SHADE_DETAIL * detail)
        unchanged = smooth & (np.abs(light - mean) < SAME_LIGHTNESS)
        same = np.count_nonzero(unchanged & known) / total
        trust = min(max((same - LOST_SHARE) / (TRUSTED_SHARE - LOST_SHARE), 0.0), 1.0)
        looks = (lit.view(np.uint8) + smooth + unchanged) * np.uint8(FULL_AGE + 1)
        looks += np.minimum(age, FULL_AGE) * known
        looks |= outside.view(np.uint8) - np.uint8(1)  # 255 in the cube
        odds = np.asarray(cv2.LUT(looks, _NOT_TRUSTED + np.float32(trust) * _TRUST), np.float32)
        self._lit_anew = lit & ~unchanged
        return Place(odds, (odds > 0) & ~lit, trust > 0, lab, background, known)

    def learn(self, lab: Floats, box: Box, free: Flags, changed: Flags) -> None:
        """Learn the pixels of a window that are free of cube and hand."""
        age = self._age[box]
        shaded = self._lit_anew & (age > FULL_AGE)
        looks = np.maximum(np.maximum(age, shaded * _SHADED), changed * _CHANGED)
        self._learn(lab, box, np.asarray(cv2.LUT(looks, _STEPS), np.float32) * free)
        age += free & (age < MAX_AGE)

    def learn_first(self, lab: Floats, box: Box, free: Flags) -> None:
        """Learn pixels that are seen seldom: each counts as several frames.

        An arm may come there before the cube does: what changed in a part of them is learned late.
        """
        age = self._age[box]
        looks = age // np.uint8(SELDOM_FRAMES)
        off = np.abs(lab - self._mean[:, box[0], box[1]]).max(axis=0) > SAME_LIGHTNESS
        off &= age >= FULL_AGE
        if np.count_nonzero(off) < MAX_ARM_SHARE * off.size:
            looks[off] = _CHANGED
        self._learn(lab, box, np.asarray(cv2.LUT(looks, _STEPS), np.float32) * free)
        age += (free & (age < MAX_AGE)) * np.uint8(SELDOM_FRAMES)

    def forget(self) -> None:
        """Forget all: the camera was moved."""
        self._age[:] = 0

    def planes(self, box: Box, where: Flags) -> list[Image]:
        """Return L, a and b of CIELab in bytes, of some pixels of a window, (n,) each."""
        offsets = (-LIGHTNESS_OFFSET, 128.0, 128.0)
        means = (plane[where] for plane in self._mean[:, box[0], box[1]])
        return [
            (mean + offset).astype(np.uint8) for mean, offset in zip(means, offsets, strict=True)
        ]

    def forget_some(self, box: Box, where: Flags) -> None:
        """Forget some pixels of a window: what was learned there was no background."""
        self._age[box][where] = 0

    def _learn(self, lab: Floats, box: Box, steps: Floats) -> None:
        for plane, mean in zip(lab, self._mean[:, box[0], box[1]], strict=True):
            mean += (plane - mean) * steps


def _roughness(gain: Floats, side: int, around: Image) -> Floats:
    """Return the least deviation from the mean of a square [px], of all pixels around."""
    detail = gain - cv2.blur(gain, (side, side))
    square = cv2.blur(detail * detail, (side, side))
    return np.asarray(cv2.sqrt(cv2.erode(square, around)), np.float32)


def _noise(deviations: Floats, least: float) -> float:
    """Return the deviation that noise makes, by the pixels that look most as before."""
    return min(max(quantile(deviations, 0.4), least), MAX_NOISE_RATIO * least)
