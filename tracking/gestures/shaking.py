"""Shakes: quick reversals of the hand."""

import math
from collections import deque

import numpy as np

from cubeling.tracking.geometry.arrays import Array

MIN_REVERSALS, WINDOW_S = 4, 0.8
"""This many reversals within this time make a shake."""

DEAD_TIME_S = 1.0
"""After a shake there is no other for this long."""

MIN_SPEED = (0.25, 5.0)
"""Only faster motion counts [m/s, rad/s]; 5 rad/s moves the corners of a cube at 0.26 m/s."""


class ShakeDetector:
    """Counts reversals of the velocity and of the angular velocity, each separately."""

    def __init__(self) -> None:
        self._last_fast: list[Array | None] = [None, None]
        self._reversals: tuple[deque[float], deque[float]] = (deque(), deque())
        self._dead_until = -np.inf

    def update(self, timestamp: float, pose: Array, velocity: Array) -> bool:
        """Return whether the velocity completes a shake."""
        for kind, limit in enumerate(MIN_SPEED):
            part = velocity[3 * kind : 3 * kind + 3]
            if math.hypot(*part.tolist()) < limit:
                continue
            before = self._last_fast[kind]
            if before is not None and float(part @ before) < 0:
                self._reversals[kind].append(timestamp)
            self._last_fast[kind] = part
        return self._is_complete(timestamp)

    def _is_complete(self, timestamp: float) -> bool:
        for times in self._reversals:
            while times and timestamp - times[0] > WINDOW_S:
                times.popleft()
        if timestamp < self._dead_until:
            return False
        if max(len(times) for times in self._reversals) < MIN_REVERSALS:
            return False
        for times in self._reversals:
            times.clear()
        self._dead_until = timestamp + DEAD_TIME_S
        return True
