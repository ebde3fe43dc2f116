"""Motions of a robot: each joint follows a sine about an offset."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@dataclass(frozen=True)
class JointSine:
    """The sine that one joint follows."""

    offset: float = 0.0
    """Its mean [°]."""

    amplitude: float = 0.0
    """Its amplitude [°]."""

    cycles: int = 1
    """Whole cycles per period of the motion, so that a loop closes."""

    phase: float = 0.0
    """Where in its cycle it starts [cycles]."""


@dataclass(frozen=True)
class SineMotion:
    """A periodic motion of the body, and the sound that starts with it."""

    name: str
    """Its name in the catalogue."""

    period: float
    """Length of one period [s]."""

    joints: dict[str, JointSine]
    """The joints that move, by name; all others stay neutral."""

    sound: str | None = None
    """The sound of a mood's loop."""

    def angles(self, t: float, joints: Sequence[str]) -> Array:
        """Return the angles of `joints` at `t` seconds into the motion, (joints,) [rad]."""
        angles = np.zeros(len(joints))
        for index, name in enumerate(joints):
            sine = self.joints.get(name)
            if sine is not None:
                turn = sine.cycles * t / self.period + sine.phase
                degrees = sine.offset + sine.amplitude * math.sin(2 * math.pi * turn)
                angles[index] = math.radians(degrees)
        return angles
