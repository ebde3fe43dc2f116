"""The joints that the host holds, and their way to the angles that it named."""

import numpy as np

from cubeling.robot.contract.motions import Array
from cubeling.robot.protocol import messages as m


class HeldJoints:
    """Which joints MOVE holds, and where each should be now."""

    def __init__(self, count: int) -> None:
        self._held = np.zeros(count, bool)
        self._start, self._goal = np.zeros(count), np.zeros(count)
        self._elapsed, self._duration = np.zeros(count), np.ones(count)

    @property
    def bits(self) -> int:
        """The held joints as STATE has them."""
        return sum(1 << int(index) for index in np.flatnonzero(self._held))

    def move(self, command: m.Move, angles: Array) -> None:
        """Let go of some joints and take others, which now have `angles` (joints,) [rad]."""
        count = len(self._held)
        moved = _mask(command.moved, count)
        self._held = self._held & ~_mask(command.released, count) | moved
        self._start = np.where(moved, angles, self._start)
        self._goal = np.where(moved, command.angles[:count], self._goal)
        self._elapsed = np.where(moved, 0.0, self._elapsed)
        self._duration = np.where(moved, max(command.duration, 1e-3), self._duration)

    def release(self) -> None:
        """Let go of all joints."""
        self._held[:] = False

    def angles(self, free: Array, seconds: float) -> Array:
        """Return where all joints should be after another time [s]: `free` where none is held."""
        if not self._held.any():
            return free
        self._elapsed = self._elapsed + seconds
        part = np.minimum(self._elapsed / self._duration, 1.0)
        return np.where(self._held, self._start + part * (self._goal - self._start), free)


def _mask(bits: int, count: int) -> np.ndarray[tuple[int], np.dtype[np.bool_]]:
    return np.array([bool(bits >> index & 1) for index in range(count)])
