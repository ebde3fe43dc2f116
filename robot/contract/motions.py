"""What a body does over time: a sine about an offset for each joint that takes part."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Sway:
    """One joint of a motion: a sine about an offset."""

    offset: float = 0.0
    """Middle of the sway [°]."""

    amplitude: float = 0.0
    """Half its width [°]."""

    times: int = 1
    """Whole cycles in one period of the motion, so that a loop closes."""

    phase: float = 0.0
    """Where in its cycle it starts [cycles]."""


@dataclass(frozen=True)
class Motion:
    """What the body does, and the sound that it starts with."""

    name: str
    """What it is called."""

    period: float
    """Length of one round [s]."""

    sways: dict[str, Sway]
    """What each joint does; those not named stay neutral."""

    sound: str | None = None
    """Name of the sound of a mood's loop."""

    def angles(self, t: float, joints: Sequence[str]) -> Array:
        """Return the angles that `joints` are to have `t` seconds into it, (joints,) [rad]."""
        angles = np.zeros(len(joints))
        for index, joint in enumerate(joints):
            sway = self.sways.get(joint)
            if sway is not None:
                turn = sway.times * t / self.period + sway.phase
                degrees = sway.offset + sway.amplitude * math.sin(2 * math.pi * turn)
                angles[index] = math.radians(degrees)
        return angles
