"""Whether the cube stands still, and whether as still as only a table can hold it."""

from collections import deque
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tracking.geometry import se3

Array = NDArray[np.float64]

WINDOW = 0.3
"""How long the cube must keep still to be called still [s]."""

STILL = (0.02, 0.2)
"""Slower than this is still [m/s, rad/s]."""

TREMOR = (2.5e-4, 3.5e-3)
"""A cube that a table holds scatters by less than this [m, rad], covariance aside.

A hand in the air trembles by 0.3 to 1 mm at 8 to 12 Hz (physiological tremor) and drifts by more.
"""


@dataclass(frozen=True)
class _Moment:
    timestamp: float
    camera_from_cube: Array
    covariance: Array


class Stillness:
    """Looks back over the last poses of the cube."""

    def __init__(self) -> None:
        self._moments: deque[_Moment] = deque()

    def clear(self) -> None:
        """Forget what was seen: the cube was hidden, or is another."""
        self._moments.clear()

    def add(self, timestamp: float, camera_from_cube: Array, covariance: Array) -> None:
        """Remember a pose, and forget those that are older than the window."""
        if self._moments and timestamp - self._moments[-1].timestamp > WINDOW:
            self._moments.clear()
        self._moments.append(_Moment(timestamp, camera_from_cube, covariance))
        # One moment older than the window stays, so that the window is always covered.
        while len(self._moments) > 2 and timestamp - self._moments[1].timestamp >= WINDOW - 1e-9:
            self._moments.popleft()

    @property
    def still(self) -> bool:
        """Whether the cube has neither moved nor turned for the whole window."""
        if not self._covered:
            return False
        steps = self._steps()
        reach = np.linalg.norm(steps.reshape(-1, 2, 3), axis=2).max(axis=0)
        return bool((reach < np.array(STILL) * WINDOW).all())

    @property
    def firm(self) -> bool:
        """Whether the cube is `still` and does not tremble as in a hand."""
        if not self.still:
            return False
        variance = self._steps().var(axis=0).reshape(2, 3).sum(axis=1)
        expected = np.mean([np.diag(moment.covariance) for moment in self._moments], axis=0)
        allowed = np.square(TREMOR) + 4 * expected.reshape(2, 3).sum(axis=1)
        return bool((variance < allowed).all())

    @property
    def _covered(self) -> bool:
        moments = self._moments
        return len(moments) >= 3 and moments[-1].timestamp - moments[0].timestamp >= WINDOW - 1e-9

    def _steps(self) -> Array:
        """Shift-turns from the first moment to each, (moments, 6)."""
        first = self._moments[0].camera_from_cube
        return np.stack([se3.delta(first, moment.camera_from_cube) for moment in self._moments])
