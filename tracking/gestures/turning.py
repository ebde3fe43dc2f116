"""Angles about the table's up axis, and turns counted past a whole one."""

import numpy as np
from numpy.typing import NDArray

from tracking.gestures.table import DIRECTIONS

Array = NDArray[np.float64]


def wrapped(angle: float) -> float:
    """Bring an angle to −π…π.

    >>> wrapped(1.5 * np.pi) == -np.pi / 2
    True
    """
    return float((angle + np.pi) % (2 * np.pi) - np.pi)


def forward_side(top_face: str) -> str:
    """Name of the side whose direction is the cube's heading.

    >>> forward_side("top"), forward_side("front"), forward_side("back")
    ('front', 'bottom', 'top')
    """
    return {"front": "bottom", "back": "top"}.get(top_face, "front")


def clockwise_angle(table_from_cube: Array, top_face: str) -> float:
    """Direction of the forward side from +z of the table [rad], clockwise seen from above."""
    forward = table_from_cube[:3, :3] @ DIRECTIONS[forward_side(top_face)]
    return float(np.arctan2(-forward[0], forward[2]))


def clockwise_angle_of(direction: Array) -> float:
    """Direction on the table, (x, z), from +z [rad], clockwise seen from above."""
    return float(np.arctan2(-direction[0], direction[1]))


class TurnCounter:
    """Adds up the way from angle to angle, always the shorter one.

    A cube that is hidden for a while is thought to have taken the shorter way too: what was not
    seen beyond half a turn is not counted.
    """

    def __init__(self) -> None:
        self._angle: float | None = None
        self._total = 0.0

    def restart(self, angle: float) -> None:
        """Count from here."""
        self._angle, self._total = angle, 0.0

    def add(self, angle: float) -> None:
        """Follow the cube to an angle [rad]; without a start there is nothing to count."""
        if self._angle is not None:
            self._total += wrapped(angle - self._angle)
            self._angle = angle

    @property
    def turns(self) -> float:
        """Turns since the start, clockwise positive."""
        return self._total / (2 * np.pi)
