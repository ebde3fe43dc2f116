"""Whether the cube stands still, and whether as still as only a table holds it."""

from collections import deque
from dataclasses import dataclass

import numpy as np

from cubeling.tracking.geometry import se3
from cubeling.tracking.geometry.arrays import Array

WINDOW_S = 0.3
"""How long the cube must keep still to count as still."""

MAX_SPEED = (0.02, 0.2)
"""Slower than this is still [m/s, rad/s]."""

MAX_TREMOR = (2.5e-4, 3.5e-3)
"""Standard deviation of a cube on a table, apart from that of its pose [m, rad]. A hand
in the air trembles by 0.3 to 1 mm at 8 to 12 Hz (physiological tremor)."""


@dataclass(frozen=True)
class _Sample:
    timestamp: float
    camera_from_cube: Array
    noise: Array


class StillnessDetector:
    """Tells from the last poses of the cube whether it stands still."""

    def __init__(self) -> None:
        self._samples: deque[_Sample] = deque()
        self._deltas: Array | None = None

    def add(self, timestamp: float, camera_from_cube: Array, noise: Array) -> None:
        """Add a pose with the variances of its noise, (6,), and drop those that are too old."""
        # Unseen for a whole window the cube may have been anywhere.
        if self._samples and timestamp - self._samples[-1].timestamp > WINDOW_S:
            self._samples.clear()
        self._samples.append(_Sample(timestamp, camera_from_cube, noise))
        # One sample older than the window stays, so that the window is always covered.
        while len(self._samples) > 2 and timestamp - self._samples[1].timestamp >= WINDOW_S - 1e-9:
            self._samples.popleft()
        self._deltas = self._deltas_from_first()

    @property
    def still(self) -> bool:
        """Whether the cube has neither moved nor turned for the whole window."""
        if self._deltas is None:
            return False
        distance = np.linalg.norm(self._deltas.reshape(-1, 2, 3), axis=2).max(axis=0)
        return bool((distance < np.array(MAX_SPEED) * WINDOW_S).all())

    @property
    def firm(self) -> bool:
        """Whether the cube is `still` and does not tremble as in a hand."""
        if self._deltas is None or not self.still:
            return False
        variance = self._deltas.var(axis=0).reshape(2, 3).sum(axis=1)
        expected = np.mean([sample.noise for sample in self._samples], axis=0)
        # Twice the standard deviation that the tracker claims: its noise is no tremor of a hand.
        allowed = np.square(MAX_TREMOR) + 4 * expected.reshape(2, 3).sum(axis=1)
        return bool((variance < allowed).all())

    def _deltas_from_first(self) -> Array | None:
        """Pose deltas from the first sample to each, (N, 6); None before they cover the window."""
        first, last = self._samples[0], self._samples[-1]
        if len(self._samples) < 3 or last.timestamp - first.timestamp < WINDOW_S - 1e-9:
            return None
        poses = np.stack([each.camera_from_cube for each in self._samples])
        return se3.deltas(poses[0], poses)
