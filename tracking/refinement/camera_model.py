"""What a camera is like: how long its shutter is open, and how its grey values follow the light."""

import numpy as np
from numpy.typing import NDArray

from tracking.refinement.alignment import Alignment
from tracking.refinement.exposure import Shutter
from tracking.refinement.tone_curve import Response

Array = NDArray[np.float64]

TELLING = 0.2
"""Cells that edges must be swept over for their tones to tell of the camera's response."""

CLEAR_SWEEP = 3.5
"""And pixels: below, an unknown lens blurs as much."""

LESSONS = 60
"""Sharp frames that are aligned as blurred ones at most, only to learn from them."""


class CameraHabits:
    """Learns exposure and tone curve of one camera from pictures of a blurred cube."""

    def __init__(self) -> None:
        self.shutter = Shutter()
        self.response = Response()
        self.lessons = 0
        """How many sharp frames were studied."""

    @property
    def exposure(self) -> float:
        """Exposure time [s]."""
        return self.shutter.exposure

    @property
    def exposure_known(self) -> bool:
        """Whether it was measured often enough."""
        return self.shutter.known

    @property
    def tone(self) -> NDArray[np.float32]:
        """Light for each grey value, (256,)."""
        return self.response.table

    @property
    def curious(self) -> bool:
        """Whether a sharp frame is worth being studied."""
        return not (self.shutter.known and self.response.known) and self.lessons < LESSONS

    def tells(self, streak: float, pixels_per_cell: float) -> bool:
        """Whether a cube that edges cross by `streak` cells is blurred enough to tell anything."""
        return streak >= TELLING and streak * pixels_per_cell >= CLEAR_SWEEP

    def learn(
        self, aligned: Alignment, velocity: Array, streak: float, pixels_per_cell: float
    ) -> None:
        """Take in an alignment of a cube that moved with a velocity, (6,)."""
        if streak * pixels_per_cell < CLEAR_SWEEP:
            return
        self.shutter.learn(*aligned.told, velocity)
        if streak > TELLING:
            self.response.learn(aligned.bend, aligned.black)
