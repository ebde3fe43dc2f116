"""What is behind the hand: a picture of the desk, learned where no hand is."""

import cv2
import numpy as np

from tracking.geometry.arrays import Flags, Floats

MIN_SHADE = 0.55
"""Least light on the background relative to the light before, as (L + 16) of CIELab: a shadow."""

CHROMA_TOLERANCE, LIGHTNESS_TOLERANCE = 6.0, 10.0
"""Difference to the background that noise makes [CIELab bytes]."""

STEP, CHANGED_STEP = 0.1, 0.015
"""Share of a frame in the background, where it looks as before and where it does not: what stays
for a hundred frames belongs to it."""

UNCHANGED, CHANGED, SHADED, UNKNOWN = -3.0, 2.0, -1.2, -0.7
"""What a pixel speaks for a hand, as the logarithm of odds."""

FULL_AGE = 20
"""Frames after which a pixel that looks as before speaks in full."""

MIN_ROUGH, MAX_ROUGH, ROUGH = 0.02**2, 0.05**2, 1.0
"""Variance of the gain in a shadow at most, and that of something else, and what it speaks then."""

MIN_KNOWN, LOST_SHARE, TRUSTED_SHARE = 0.2, 0.25, 0.45
"""Share of a window that must be known; and of that, how much must look as before to trust the
rest: less, and the camera was moved."""

BLACK = 41.0
"""16 of CIELab's L in bytes: light scales L + 16, and the chroma by the same factor."""

Box = tuple[slice, slice]
"""Rows and columns of a window."""


class Background:
    """A picture of what the camera shows without the hand, at one resolution."""

    def __init__(self) -> None:
        self._mean: Floats = np.zeros((3, 0, 0), np.float32)
        self._age: Floats = np.zeros((0, 0), np.float32)

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
        known = (age > 0) & outside
        gain = (lab[0] + BLACK) / (mean[0] + BLACK)
        off_a = lab[1] - 128 - gain * (mean[1] - 128)
        off_b = lab[2] - 128 - gain * (mean[2] - 128)
        same_colour = off_a * off_a + off_b * off_b < CHROMA_TOLERANCE**2
        lightness = lab[0] - mean[0]
        unchanged = same_colour & (np.abs(lightness) < LIGHTNESS_TOLERANCE)
        total = np.count_nonzero(known)
        if total < MIN_KNOWN * max(np.count_nonzero(outside), 1):
            return np.full(age.shape, UNKNOWN, np.float32), np.zeros(age.shape, bool), True
        same = np.count_nonzero(unchanged & known) / total
        trust = float(np.clip((same - LOST_SHARE) / (TRUSTED_SHARE - LOST_SHARE), 0, 1))
        shaded = same_colour & (gain > MIN_SHADE) & (lightness < LIGHTNESS_TOLERANCE)
        # A shadow keeps the texture of what it falls on, so the gain is smooth.
        middle = cv2.blur(gain, (5, 5))
        rough = cv2.blur(gain * gain, (5, 5)) - middle * middle
        odds = np.clip((rough - MIN_ROUGH) * ((ROUGH - SHADED) / (MAX_ROUGH - MIN_ROUGH)), 0, None)
        odds = np.minimum(odds + SHADED, ROUGH)
        odds[~shaded] = CHANGED
        as_before = np.minimum(age * (1 / FULL_AGE), 1) * (UNCHANGED - UNKNOWN) + UNKNOWN
        odds = np.where(unchanged, as_before, odds) * np.float32(trust)
        odds[~known] = UNKNOWN
        return odds.astype(np.float32), (odds > 0) & known, trust > 0

    def learn(self, lab: Floats, box: Box, free: Flags, changed: Flags) -> None:
        """Learn the pixels of a window that are free of cube and hand."""
        mean, age = self._mean[:, box[0], box[1]], self._age[box]
        step = np.maximum(1 / (age + 1), STEP)
        step[changed] = CHANGED_STEP
        step *= free
        mean += (lab - mean) * step.astype(np.float32)
        age += free

    def forget(self) -> None:
        """Forget all: the camera was moved."""
        self._age[:] = 0
