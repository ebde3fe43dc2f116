"""Angles about the table's up axis, and unwrapped turns."""

import numpy as np

from cubeling.tracking.geometry.arrays import Array
from cubeling.tracking.gestures.table import SIDE_NORMALS


def wrap_angle(angle: float) -> float:
    """Wrap an angle to −π…π.

    >>> wrap_angle(1.5 * np.pi) == -np.pi / 2
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
    forward = table_from_cube[:3, :3] @ SIDE_NORMALS[forward_side(top_face)]
    return float(np.arctan2(-forward[0], forward[2]))


def clockwise_angle_of(direction: Array) -> float:
    """Direction on the table, (x, z), from +z [rad], clockwise seen from above."""
    return float(np.arctan2(-direction[0], direction[1]))


class TurnCounter:
    """Unwraps angles: each step is the shorter way around, also after the cube was hidden."""

    def __init__(self) -> None:
        self._angle: float | None = None
        self._total = 0.0

    def restart(self, angle: float) -> None:
        """Count from an angle [rad] on; the sum is 0 again."""
        self._angle, self._total = angle, 0.0

    def add(self, angle: float) -> None:
        """Count up to an angle [rad]; without a start nothing is counted."""
        if self._angle is not None:
            self._total += wrap_angle(angle - self._angle)
            self._angle = angle

    @property
    def turns(self) -> float:
        """Turns since the start, clockwise positive."""
        return self._total / (2 * np.pi)
