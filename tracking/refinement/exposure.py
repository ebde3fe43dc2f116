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

    @property
    def known(self) -> bool:
        """Whether it was measured often enough."""
        return len(self._measured) > KEPT // 2

    def learn(self, pull: Array, information: Array, velocity: Array) -> None:
        """Take in what one blurred picture says of the sweep, at a known velocity, (6,).

        Parameters
        ----------
        pull
            Information times the sweep that explains the picture best, (6,).
        information
            About the sweep, from the picture alone, (6, 6).
        velocity
            Of the cube, (6,).
        """
        strength = float(velocity @ information @ velocity)
        # Only motion that blurs much more than the blur is uncertain tells anything.
        if strength * self.exposure**2 < 100:
            return
        self._measured.append(float(np.clip(velocity @ pull / strength, 0.0, LONGEST)))
        self.exposure = float(np.median(self._measured))
