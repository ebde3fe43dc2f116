"""What is behind the hand: a picture of the desk, learned where no hand is."""

import cv2
import numpy as np

from tracking.appearance.colour_model import LIGHTNESS_OFFSET
from tracking.geometry.arrays import Flags, Floats
from tracking.geometry.robust_statistics import quantile

MIN_GAIN, MAX_GAIN = 0.45, 2.0
"""Least and most light on the background relative to the light before, as L + 16 of CIELab: a
shadow that comes or goes."""

MIN_CHROMA_NOISE, MIN_GAIN_NOISE = 0.3, 0.003
"""Least deviation of chroma [CIELab] and of the gain that noise makes at working resolution."""

CHROMA_LIMIT, GAIN_LIMIT = 4.0, 2.5
"""Deviations of noise from which on a pixel is something else."""

SHADE_CHROMA, SHADE_DETAIL = 10.0, 0.05
"""How much chroma [CIELab] and detail of the gain change in a shadow, per change of the gain."""

MAX_NOISE_RATIO = 3.0
"""Most noise that is believed, relative to the least."""

SMALL = np.ones((3, 3), np.uint8)
"""A pixel and its neighbours."""

NOISE_STRIDE = 4
"""Rows and columns of which one is used to estimate noise."""

SAME_LIGHTNESS = 9.0
"""Change of lightness below which a pixel looks as before [CIELab bytes]."""

STEP, SHADED_STEP, CHANGED_STEP = 0.1, 0.02, 0.01
"""Share of a frame in the background, where it looks as before and where it does not: what stays
for a hundred frames belongs to it."""

UNCHANGED, CHANGED, SHADED, UNKNOWN = -3.0, 2.5, -1.2, -0.7
"""What a pixel speaks for a hand, as the logarithm of odds."""

FULL_AGE = 6
"""Frames after which a pixel is known for sure."""

SELDOM_FRAMES = 3
"""Frames that a pixel counts for outside the window."""

MIN_KNOWN, LOST_SHARE, TRUSTED_SHARE = 0.2, 0.4, 0.6
"""Share of a window that must be known; and of that, how much must look as before to trust the
rest: less, and the camera was moved."""

Box = tuple[slice, slice]
"""Rows and columns of a window."""


class Background:
    """A picture of what the camera shows without the hand, at one resolution."""

    def __init__(self) -> None:
        self._mean: Floats = np.zeros((3, 0, 0), np.float32)
        self._age: Floats = np.zeros((0, 0), np.float32)
        self._lit_anew: Flags = np.zeros((0, 0), bool)

    def match_size(self, width: int, height: int) -> None:
        """Change the resolution: it follows that in which the hand is looked for."""
        if self._age.size == 0:
            self._mean = np.zeros((3, height, width), np.float32)
            self._age = np.zeros((height, width), np.float32)
        elif self._age.shape != (height, width):
            planes = [cv2.resize(plane, (width, height)) for plane in self._mean]
            self._mean = np.stack(planes).astype(np.float32)
            # A pixel of which a neighbour is unknown is unknown.
            unknown = cv2.resize((self._age == 0).astype(np.float32), (width, height))
            age = cv2.resize(self._age, (width, height))
            self._age = np.where(unknown > 0, 0, age).astype(np.float32)

    def odds(self, lab: Floats, box: Box, outside: Flags) -> tuple[Floats, Flags, bool]:
        """Return what each pixel speaks for a hand, whether it changed, and whether all is known.

        Parameters
        ----------
        lab
            CIELab of a window in the range of bytes, (3, h, w).
        box
            Rows and columns of the window.
        outside
            Pixels outside the cube.

        Returns
        -------
        The logarithm of odds, (h, w); the pixels that look like something else, (h, w); and False
        where so little looks as before that the camera must have moved.
        """
        mean, age = self._mean[:, box[0], box[1]], self._age[box]
        # The neighbours take part in what follows.
        known = cv2.erode(((age > 0) & outside).astype(np.uint8), SMALL) > 0
        sparse = np.s_[::NOISE_STRIDE, ::NOISE_STRIDE]
        some = known[sparse]
        total = np.count_nonzero(known)
        if total < max(MIN_KNOWN * np.count_nonzero(outside), 200) or not some.any():
            self._lit_anew = np.zeros(age.shape, bool)
            return np.full(age.shape, UNKNOWN, np.float32), np.zeros(age.shape, bool), True
        gain = (lab[0] + LIGHTNESS_OFFSET) / (mean[0] + LIGHTNESS_OFFSET)
        off_a = lab[1] - 128 - gain * (mean[1] - 128)
        off_b = lab[2] - 128 - gain * (mean[2] - 128)
        # The camera's white balance drifts.
        off_a -= quantile(off_a[sparse][some], 0.5)
        off_b -= quantile(off_b[sparse][some], 0.5)
        off_a, off_b = cv2.blur(off_a, (3, 3)), cv2.blur(off_b, (3, 3))
        chroma = np.sqrt(off_a * off_a + off_b * off_b)
        # A shadow keeps the texture of what it falls on, so the gain is smooth.
        detail = gain - cv2.blur(gain, (3, 3))
        rough = np.sqrt(cv2.erode(cv2.blur(detail * detail, (3, 3)), SMALL))
        shade = np.abs(gain - 1)
        chroma_noise = _noise(chroma[sparse][some], MIN_CHROMA_NOISE)
        gain_noise = _noise(rough[sparse][some], MIN_GAIN_NOISE)
        foreign = np.maximum(
            chroma / (CHROMA_LIMIT * chroma_noise + SHADE_CHROMA * shade),
            rough / (GAIN_LIMIT * gain_noise + SHADE_DETAIL * shade),
        )
        lit = (gain > MIN_GAIN) & (gain < MAX_GAIN) & (foreign < 1)
        unchanged = lit & (np.abs(lab[0] - mean[0]) < SAME_LIGHTNESS)
        same = np.count_nonzero(unchanged & known) / total
        trust = float(np.clip((same - LOST_SHARE) / (TRUSTED_SHARE - LOST_SHARE), 0, 1))
        looks = lit.view(np.uint8) + unchanged  # an unchanged pixel is lit
        odds = np.take(
            np.array([CHANGED, SHADED, UNCHANGED], np.float32) * np.float32(trust), looks
        )
        odds = UNKNOWN + (odds - UNKNOWN) * np.minimum(age * np.float32(1 / FULL_AGE), 1)
        odds[~known] = UNKNOWN
        self._lit_anew = lit & ~unchanged
        return odds, (odds > 0) & known, trust > 0

    def learn(self, lab: Floats, box: Box, free: Flags, changed: Flags) -> None:
        """Learn the pixels of a window that are free of cube and hand."""
        mean, age = self._mean[:, box[0], box[1]], self._age[box]
        step = np.maximum(1 / (age + 1), STEP)
        step[self._lit_anew & (age > FULL_AGE)] = SHADED_STEP
        step[changed] = CHANGED_STEP
        step *= free
        mean += (lab - mean) * step.astype(np.float32)
        age += free

    def learn_first(self, lab: Floats, box: Box, free: Flags) -> None:
        """Learn pixels that are seen seldom: each counts as several frames."""
        mean, age = self._mean[:, box[0], box[1]], self._age[box]
        mean += (lab - mean) * (free * np.maximum(1 / (age / SELDOM_FRAMES + 1), STEP)).astype(
            np.float32
        )
        age += SELDOM_FRAMES * free

    def forget(self) -> None:
        """Forget all: the camera was moved."""
        self._age[:] = 0


def _noise(deviations: Floats, least: float) -> float:
    """Return the deviation that noise makes, by the pixels that look most as before."""
    return float(np.clip(quantile(deviations, 0.4), least, MAX_NOISE_RATIO * least))
