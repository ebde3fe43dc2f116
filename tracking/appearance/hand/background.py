"""What is behind the hand: a picture of the desk, learned where no hand is."""

import math
from dataclasses import dataclass, replace

import cv2
import numpy as np

from cubeling.tracking.appearance.hand.camera_change import camera_change
from cubeling.tracking.appearance.hand.components import at_border
from cubeling.tracking.appearance.hand.shading import (
    DETAIL_LIMIT,
    EDGE_DETAIL,
    EVEN_LIGHT_PX,
    MIN_CHROMA_NOISE,
    MIN_DETAIL_NOISE,
    SHADE_DETAIL,
    TEXTURE_DETAIL,
    may_be_light,
    measured_noise,
    roughness,
    texture,
)
from cubeling.tracking.appearance.hand.structuring_elements import SQUARE_3
from cubeling.tracking.geometry.arrays import Flags, Floats, Image

SPARSE = np.s_[::5, ::5]
"""Pixels by which noise, exposure and white balance are estimated."""

GRID_PX, MIDDLES = 3, slice(1, None, 3)
"""Side of the squares of pixels of which the middle is a sample: by these are found the part of a
window that differs, and the arm [px]; and where the middles are."""

MIN_CHANGE = 5.0
"""Change of lightness or chroma from which on a pixel of that grid differs [CIELab bytes]."""

MIN_ARM_SAMPLES = 20
"""Samples, with their neighbours, above which what differs and comes from outside the window may be
an arm."""

SAMPLE_NOISE = 2.0
"""Noise of a sample relative to that of a pixel of the window, which is the mean of several."""

MARGIN_PX = 6
"""What is added around the part of a window that differs [px]."""

RECOLOURED_SHARE = 0.2
"""Change of chroma from which on a shadow is out of the question, as a share of L + 16."""

SAME_LIGHTNESS = 9.0
"""Change of lightness below which a pixel looks as before, if it is not something else [CIELab
bytes]; and of chroma as well where it is seen seldom."""

STEP, SHADED_STEP, CHANGED_STEP = 0.1, 0.02, 0.01
"""Share of one more picture in the background: at least, where it looks as before; where that was
known for sure and is in other light; and where it is something else. It takes 10, 50 and 100
pictures that are learned to change two thirds of the background."""

UNCHANGED, CHANGED, SHADED, ROUGH, UNKNOWN = -3.0, 2.5, -1.2, 1.6, -0.4
"""What a pixel speaks for a hand, as the logarithm of odds; rough is what may be the edge of a
shadow, or skin in the colour of the desk."""

FULL_AGE = 6
"""Frames for which a pixel must be known, to be known for sure."""

SELDOM_FRAMES, MAX_AGE = 3, 40
"""Frames that one picture counts for outside the window, where a pixel is seen seldom; and those
from which on no more are counted."""

MIN_KNOWN, MIN_KNOWN_PX = 0.2, 200
"""Least share of a window that must be known to compare it, and least pixels."""

LOST_SHARE, TRUSTED_SHARE = 0.4, 0.6
"""Share of the known pixels that look as before, up to which the camera was moved, and from which
on the background is trusted wholly."""

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
class WindowChange:
    """What a window of the picture is, compared with the background there."""

    odds: Floats
    """What each pixel speaks for a hand, (h, w): logarithm of odds, 0 in the cube."""

    changed: Flags
    """Pixels that look like something else, (h, w)."""

    difference: Floats
    """How much it differs, in lightness and chroma, (h, w) [CIELab bytes], 0 where unknown and in
    the cube."""

    relit: Flags
    """Pixels that look like the background in other light, (h, w)."""

    recoloured: Flags
    """Pixels of another hue or saturation than before, which no shadow gives them, (h, w)."""

    lights: tuple[Floats, Floats]
    """L + 16 of CIELab of picture and background, in bytes, (h, w)."""

    def without(self, mistaken: Flags) -> "WindowChange":
        """Return the same where the background is not known in some pixels."""
        odds = self.odds.copy()
        odds[mistaken] = UNKNOWN
        return replace(self, odds=odds, changed=self.changed & ~mistaken)

    def likeness(self, where: Flags) -> float:
        """Return how alike the details of picture and background are in some pixels, -1…1.

        It is the correlation, and near 0 for a hand. A textured thing that has moved by less than
        a pixel looks like something else at most pixels, and yet is much like itself.
        """
        now, before = ((light - cv2.blur(light, EVEN_LIGHT_PX))[where] for light in self.lights)
        norm = math.sqrt(float(now @ now) * float(before @ before))
        return float(now @ before) / max(norm, 1e-6)


class Background:
    """A picture of what the camera shows without the hand, at one resolution."""

    def __init__(self) -> None:
        self._mean: Floats = np.zeros((3, 0, 0), np.float32)
        self._sampled_mean = self._mean  # the samples of it, side by side: they are read faster
        self._age: Image = np.zeros((0, 0), np.uint8)
        self._texture: Floats = np.zeros((0, 0), np.float32)
        self._chroma_noise, self._detail_noise = MIN_CHROMA_NOISE, MIN_DETAIL_NOISE
        self._trust = 1.0

    @property
    def steady(self) -> bool:
        """False where so little looked as before that the camera must have moved."""
        return self._trust > 0

    def match_size(self, width: int, height: int) -> None:
        """Change the resolution: it follows that in which the hand is looked for."""
        if self._age.size == 0:
            self._mean = np.ones((3, height, width), np.float32)
            self._age = np.zeros((height, width), np.uint8)
            self._texture = np.zeros((height, width), np.float32)
        elif self._age.shape != (height, width):
            planes = [cv2.resize(plane, (width, height)) for plane in self._mean]
            self._mean = np.stack(planes).astype(np.float32)
            self._texture = np.asarray(cv2.resize(self._texture, (width, height)), np.float32)
            # A pixel of which a neighbour is unknown is unknown.
            unknown = cv2.resize((self._age == 0).astype(np.float32), (width, height))
            age = np.asarray(cv2.resize(self._age, (width, height)), np.uint8)
            self._age = age * (unknown == 0)
        else:
            return
        self._sampled_mean = self._mean[:, MIDDLES, MIDDLES].copy()

    def camera_change(self, lab: Floats, box: Box) -> Floats | None:
        """Return what undoes a change of exposure and white balance, (3, 3); None without one.

        It multiplies `lab`, which is as in `compare`.
        """
        known = self._age[box][SPARSE] > 0
        now, before = lab[:, *SPARSE][:, known], self._mean[:, *box][:, *SPARSE][:, known]
        return camera_change(now, before)

    def compare(self, lab: Floats, box: Box, outside: Flags, whole: bool) -> WindowChange:
        """Compare a window of the picture with the background.

        Parameters
        ----------
        lab
            L + 16, a and b of CIELab of a window, in bytes, (3, h, w).
        box
            Rows and columns of the window.
        outside
            Pixels outside the cube.
        whole
            Whether that is enough to measure noise, texture and trust, which keep until it is
            again.
        """
        light, a, b = lab
        (mean, mean_a, mean_b), age = self._mean[:, *box], self._age[box]
        known = (age > 0) & outside
        if whole and not _is_enough(known):
            self._trust = 1.0
            odds, none = np.float32(UNKNOWN) * outside, np.zeros(age.shape, bool)
            return WindowChange(odds, none, np.zeros_like(light), none, none, (light, mean))
        gain = light / mean
        off_a, off_b = a - gain * mean_a, b - gain * mean_b
        # What is large at a pixel and around it is neither noise nor the blur of its neighbour.
        off = cv2.magnitude(off_a, off_b)
        chroma = cv2.min(off, cv2.magnitude(cv2.blur(off_a, (3, 3)), cv2.blur(off_b, (3, 3))))
        gain -= 1
        shade = np.abs(gain)
        lit = may_be_light(chroma, gain, shade, self._chroma_noise)
        # Noise of the lightness is the same in bright and in dark places, so that of the gain not.
        rough = mean * roughness(gain, known, lit)
        if whole:
            some = known[SPARSE]
            self._chroma_noise = measured_noise(chroma[SPARSE][some], MIN_CHROMA_NOISE)
            self._detail_noise = measured_noise(rough[SPARSE][some], MIN_DETAIL_NOISE)
            self._texture[box] = TEXTURE_DETAIL * texture(mean)
        shade *= mean  # in lightness from here on
        rough -= self._texture[box]
        lit &= rough < DETAIL_LIMIT * self._detail_noise + EDGE_DETAIL * shade
        smooth = lit & (rough < DETAIL_LIMIT * self._detail_noise + SHADE_DETAIL * shade)
        unchanged = smooth & (shade < SAME_LIGHTNESS)
        if whole:
            self._trust = _trust(np.count_nonzero(unchanged & known) / np.count_nonzero(known))
        looks = lit.view(np.uint8) + smooth + unchanged
        odds = self._odds(looks, np.minimum(age, FULL_AGE) * known, outside)
        difference = (shade + np.float32(2) * off) * known
        recoloured = off > np.float32(RECOLOURED_SHARE) * light
        changed, relit = (odds > 0) & ~lit, lit & ~unchanged
        return WindowChange(odds, changed, difference, relit, recoloured, (light, mean))

    def _odds(self, looks: Image, age: Image, outside: Flags) -> Floats:
        """Return what each pixel speaks for a hand, (h, w): logarithm of odds.

        `looks` counts what is true of it: lit, smooth, unchanged; `age` is `FULL_AGE` at most.
        """
        looks = looks * np.uint8(FULL_AGE + 1)
        looks += age
        looks |= outside.view(np.uint8) - np.uint8(1)  # 255 in the cube
        table = _NOT_TRUSTED + np.float32(self._trust) * _TRUST
        return np.asarray(cv2.LUT(looks, table), np.float32)

    def difference_box(self, lab: Floats, samples: Box, start: Box) -> Box:
        """Return the rows and columns with what differs around a part, or comes from outside.

        Parameters
        ----------
        lab
            Samples of what `compare` takes: the middle of each square of `GRID_PX` pixels.
        samples
            Rows and columns of those of the window.
        start
            Rows and columns in the window of that part: the cube.
        """
        flags = np.abs(lab - self._sampled_mean[:, *samples]).max(axis=0) > MIN_CHANGE
        flags |= self.sampled_age(samples) == 0
        rows, columns = (slice(side.start // GRID_PX, side.stop // GRID_PX + 1) for side in start)
        flags[rows, columns] = True
        near = cv2.dilate(flags.view(np.uint8), SQUARE_3)
        count, labels = cv2.connectedComponents(near)
        chosen = at_border(labels, count)
        chosen &= np.bincount(labels.ravel(), minlength=count) > MIN_ARM_SAMPLES
        chosen[0], chosen[labels[rows.start, columns.start]] = False, True
        left, top, width, height = cv2.boundingRect(chosen[labels].view(np.uint8))
        return _grow(top, top + height), _grow(left, left + width)

    def changed_samples(self, lab: Floats, samples: Box) -> Flags:
        """Return which samples look like something else, and not as in a shadow, (h, w)."""
        mean, mean_a, mean_b = self._sampled_mean[:, *samples]
        gain = lab[0] / mean
        off = cv2.magnitude(lab[1] - gain * mean_a, lab[2] - gain * mean_b)
        gain -= 1
        lit = may_be_light(off, gain, np.abs(gain), SAMPLE_NOISE * self._chroma_noise)
        return np.asarray(~lit & (self.sampled_age(samples) > 0))

    def sampled_age(self, samples: Box) -> Image:
        """Return what `age` does, of some samples."""
        return self._age[MIDDLES, MIDDLES][samples]

    def sampled_lab(self, samples: Box, where: Flags) -> Floats:
        """Return what `lab` does, of some samples, (3, n)."""
        return self._sampled_mean[:, *samples][:, where]

    def learn(self, lab: Floats, box: Box, free: Flags, place: WindowChange) -> None:
        """Learn the pixels of a window that are free of cube and hand, after `compare`."""
        age = self._age[box]
        relit = place.relit & (age > FULL_AGE)
        looks = np.maximum(np.maximum(age, relit * _SHADED), place.changed * _CHANGED)
        self._learn(lab, box, np.asarray(cv2.LUT(looks, _STEPS), np.float32) * free)
        age += free & (age < MAX_AGE)

    def learn_first(self, lab: Floats, box: Box, free: Flags) -> None:
        """Learn pixels that are seen seldom: each counts as several frames.

        An arm may come there before the cube does: what changed in a part of them is learned late.
        """
        age = self._age[box]
        looks = age // np.uint8(SELDOM_FRAMES)
        off = np.abs(lab - self._mean[:, *box]).max(axis=0) > SAME_LIGHTNESS
        off &= age >= FULL_AGE
        if np.count_nonzero(off) < MAX_ARM_SHARE * off.size:
            looks[off] = _CHANGED
        self._learn(lab, box, np.asarray(cv2.LUT(looks, _STEPS), np.float32) * free)
        age += (free & (age < MAX_AGE)) * np.uint8(SELDOM_FRAMES)

    def forget(self) -> None:
        """Forget all: the camera was moved."""
        self._age[:], self._trust = 0, 1.0

    def age(self, box: Box) -> Image:
        """Return for how many frames each pixel of a window is known, (h, w): see `MAX_AGE`."""
        return self._age[box]

    def lab(self, box: Box, where: Flags) -> Floats:
        """Return L + 16, a and b of CIELab in bytes, of some pixels of a window, (3, n)."""
        return self._mean[:, *box][:, where]

    def forget_some(self, box: Box, where: Flags) -> None:
        """Forget some pixels of a window: what was learned there was no background."""
        self._age[box][where] = 0

    def forget_samples(self, samples: Box, where: Flags) -> None:
        """Forget the squares of some samples, (h, w)."""
        rows, columns = (slice(GRID_PX * side.start, GRID_PX * side.stop) for side in samples)
        self.forget_some((rows, columns), where.repeat(GRID_PX, 0).repeat(GRID_PX, 1))

    def _learn(self, lab: Floats, box: Box, steps: Floats) -> None:
        for plane, mean in zip(lab, self._mean[:, *box], strict=True):
            mean += (plane - mean) * steps
        ends = (side.indices(count) for side, count in zip(box, self._age.shape, strict=True))
        rows, columns = (
            slice((low + 1) // GRID_PX, (high + 1) // GRID_PX) for low, high, _ in ends
        )
        middles = self._mean[:, MIDDLES, MIDDLES]
        self._sampled_mean[:, rows, columns] = middles[:, rows, columns]


def _is_enough(known: Flags) -> bool:
    """Return whether so much of a window is known that it can be compared."""
    enough = np.count_nonzero(known) >= max(MIN_KNOWN * known.size, MIN_KNOWN_PX)
    return bool(enough and known[SPARSE].any())


def _trust(same: float) -> float:
    """Return how far the background is trusted, 0…1, if that share looks as before."""
    return min(max((same - LOST_SHARE) / (TRUSTED_SHARE - LOST_SHARE), 0.0), 1.0)


def _grow(first: int, stop: int) -> slice:
    """Return the pixels of some rows or columns of samples, and those around."""
    return slice(max(first * GRID_PX - MARGIN_PX, 0), stop * GRID_PX + MARGIN_PX)
