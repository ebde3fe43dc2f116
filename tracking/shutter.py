"""How long the camera's shutter is open, learnt from how far the cube blurs."""

from collections import deque

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

FIRST = 0.010
"""Exposure that is assumed until blur tells it [s]: a webcam's indoors, roughly."""

LONGEST = 0.05
"""No exposure is longer than this [s]."""

KEPT = 15
"""The median of so many measurements counts."""


class Shutter:
    """The exposure time of one camera.

    A cube that moves with velocity v sweeps v·τ while the shutter is open; the ratio of the two,
    weighted by what the blur tells of each direction, is τ.
    """

    def __init__(self) -> None:
        self._measured: deque[float] = deque(maxlen=KEPT)
        self.exposure = FIRST
        """The best estimate [s]."""

    def learn(self, sweep: Array, covariance: Array, velocity: Array) -> None:
        """Take in a sweep, (6,), with its covariance, (6, 6), at a known velocity, (6,)."""
        told = np.linalg.solve(covariance, velocity)
        strength = float(velocity @ told)
        # Only motion that blurs much more than the blur is uncertain tells anything.
        if strength * self.exposure**2 < 100:
            return
        self._measured.append(float(np.clip(sweep @ told / strength, 0.0, LONGEST)))
        self.exposure = float(np.median(self._measured))
