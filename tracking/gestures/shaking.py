"""Shakes: quick reversals of the hand."""

from collections import deque

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

REVERSALS = 4
"""So many make a shake …"""

WITHIN = 0.8
"""… if they come within this time [s]."""

DEAD_TIME = 1.0
"""After a shake there is no other for this long [s]."""

FAST = (0.25, 5.0)
"""Only faster movement counts [m/s, rad/s]; 5 rad/s moves the corners of a cube by 0.26 m/s."""


class ShakeDetector:
    """Counts reversals of the velocity and of the angular velocity, each on its own."""

    def __init__(self) -> None:
        self._fast: list[Array | None] = [None, None]
        self._reversals: tuple[deque[float], deque[float]] = (deque(), deque())
        self._deaf_until = -np.inf

    def update(self, timestamp: float, velocity: Array) -> bool:
        """Take in a velocity, (6,), and tell whether it completes a shake."""
        for kind, limit in enumerate(FAST):
            part = velocity[3 * kind : 3 * kind + 3]
            if float(np.linalg.norm(part)) < limit:
                continue
            before = self._fast[kind]
            if before is not None and float(part @ before) < 0:
                self._reversals[kind].append(timestamp)
            self._fast[kind] = part
        return self._complete(timestamp)

    def _complete(self, timestamp: float) -> bool:
        for times in self._reversals:
            while times and timestamp - times[0] > WITHIN:
                times.popleft()
        if timestamp < self._deaf_until:
            return False
        if max(len(times) for times in self._reversals) < REVERSALS:
            return False
        for times in self._reversals:
            times.clear()
        self._deaf_until = timestamp + DEAD_TIME
        return True
