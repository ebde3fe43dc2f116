"""What is behind the hand: a picture of the desk, learned where no hand is."""

import cv2
import numpy as np

from tracking.geometry.arrays import Flags, Floats, Image

MIN_SHADE, MAX_GAIN = 0.55, 1.10
"""Light on the background relative to the light before: within is a shadow, not another thing."""

CHROMA_TOLERANCE, LIGHTNESS_TOLERANCE = 6.0, 10.0
"""Difference to the background that noise makes [CIELab bytes]."""

STEP, CHANGED_STEP = 0.1, 0.015
"""Share of a frame in the background, where it looks as before and where it does not: what stays
for a hundred frames belongs to it."""

UNCHANGED, CHANGED, SHADED, UNKNOWN = -3.0, 2.0, -1.2, -0.7
"""What a pixel speaks for a hand, as the logarithm of odds."""

MIN_ROUGH, MAX_ROUGH, ROUGH = 0.02**2, 0.05**2, 1.0
"""Variance of the gain in a shadow at most, and that of something else, and what it speaks then."""

MIN_KNOWN, LOST_SHARE, TRUSTED_SHARE = 0.2, 0.25, 0.45
"""Share of a window that must be known; and of that, how much must look as before to trust the
rest: less, and the camera was moved."""


class Background:
    """A picture of what the camera shows without the hand, at one resolution."""

    def __init__(self) -> None:
        self._mean: Floats = np.zeros((0, 0, 3), np.float32)
        self._age: Image = np.zeros((0, 0), np.uint8)

    def match_size(self, width: int, height: int) -> None:
        """Change the resolution: it follows the working resolution of the cube."""
        if self._age.size == 0:
            self._mean = np.zeros((height, width, 3), np.float32)
            self._age = np.zeros((height, width), np.uint8)
        elif self._age.shape != (height, width):
            self._mean = np.asarray(cv2.resize(self._mean, (width, height)), np.float32)
            known = cv2.resize(self._age, (width, height), interpolation=cv2.INTER_NEAREST)
            self._age = np.asarray(known, np.uint8)

    def odds(self, lab: Image, box: tuple[slice, slice], outside: Flags) -> tuple[Floats, float]:
        """Return what each pixel speaks for a hand, (h, w), and how far the picture is trusted.

        Parameters
        ----------
        lab
            CIELab of a window, bytes, (h, w, 3).
        box
            Rows and columns of the window.
        outside
            Pixels outside the cube.
        """
        mean, known = self._mean[box], (self._age[box] > 0) & outside
        change = lab.astype(np.float32)
        gain = (change[..., 0] + 41.0) / (mean[..., 0] + 41.0)
        off_a = change[..., 1] - 128.0 - gain * (mean[..., 1] - 128.0)
        off_b = change[..., 2] - 128.0 - gain * (mean[..., 2] - 128.0)
        chroma = off_a * off_a + off_b * off_b
        same_colour = chroma < CHROMA_TOLERANCE**2
        lightness = change[..., 0] - mean[..., 0]
        unchanged = same_colour & (np.abs(lightness) < LIGHTNESS_TOLERANCE)
        shaded = same_colour & (gain > MIN_SHADE) & (lightness < LIGHTNESS_TOLERANCE)
        # A shadow keeps the texture of what it falls on, so the gain is smooth.
        mean_gain = cv2.blur(gain, (5, 5))
        rough = cv2.blur(gain * gain, (5, 5)) - mean_gain * mean_gain
        smooth = np.clip((rough - MIN_ROUGH) / (MAX_ROUGH - MIN_ROUGH), 0, 1)
        as_shade = SHADED + (ROUGH - SHADED) * smooth
        odds = np.where(unchanged, UNCHANGED, np.where(shaded, as_shade, CHANGED))
        odds = np.where(known, odds, UNKNOWN).astype(np.float32)
        total, all_outside = np.count_nonzero(known), np.count_nonzero(outside)
        if total < MIN_KNOWN * max(all_outside, 1):
            return odds, 0.0
        same = np.count_nonzero(unchanged & known) / total
        trust = float(np.clip((same - LOST_SHARE) / (TRUSTED_SHARE - LOST_SHARE), 0, 1))
        return np.where(known, odds * np.float32(trust), odds), trust

    def learn(self, lab: Image, box: tuple[slice, slice], free: Flags, odds: Floats) -> None:
        """Learn the pixels of a window that are free of cube and hand."""
        mean, age = self._mean[box], self._age[box]
        step = np.where(odds > 0, CHANGED_STEP, STEP)
        step = np.maximum(step, (odds <= 0) / (age + 1.0)) * free
        step[free & (age == 0)] = 1.0
        mean += (lab - mean) * step[..., None].astype(np.float32)
        age[free] = np.minimum(age[free], 200) + 1

    def forget(self) -> None:
        """Forget all: the camera was moved."""
        self._age[:] = 0
