"""Paths of the benchmark's cube: Halton points and smooth sums of sines."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

PRIMES = (2, 3, 5, 7, 11, 13)

Poses = Callable[[NDArray[np.float64]], NDArray[np.float64]]
"""Times (n,) [s] to poses camera_from_cube (n, 4, 4)."""


def halton(index: int, shift: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return point `index` of the Halton sequence (Halton 1960), turned by `shift`, each 0…1.

    >>> halton(3, np.zeros(3)).round(3).tolist()
    [0.75, 0.111, 0.6]
    """
    point = np.empty(len(shift))
    for axis, prime in enumerate(PRIMES[: len(shift)]):
        value, weight, rest = 0.0, 1.0, index
        while rest:
            rest, digit = divmod(rest, prime)
            weight /= prime
            value += weight * digit
        point[axis] = value
    return np.asarray((point + shift) % 1.0)


def uniform_rotation(point: NDArray[np.float64]) -> Rotation:
    """Return the rotation of a point (3,) of the unit cube; evenly spread (Shoemake 1992)."""
    first, second = np.sqrt(1 - point[0]), np.sqrt(point[0])
    a, b = 2 * np.pi * point[1], 2 * np.pi * point[2]
    return Rotation.from_quat(
        [first * np.sin(a), first * np.cos(a), second * np.sin(b), second * np.cos(b)]
    )


def matrices(rotation: Rotation, place: NDArray[np.float64]) -> NDArray[np.float64]:
    """Poses (n, 4, 4) of n rotations and n places (n, 3) [m]."""
    poses = np.zeros((len(place), 4, 4))
    poses[:, :3, :3] = rotation.as_matrix()
    poses[:, :3, 3] = place
    poses[:, 3, 3] = 1
    return poses


def minimum_jerk(time: NDArray[np.float64], start: float, length: float) -> NDArray[np.float64]:
    """Rise from 0 to 1 without a jump in speed or acceleration (Flash and Hogan 1985)."""
    s = np.clip((time - start) / length, 0, 1)
    return np.asarray(s**3 * (10 + s * (6 * s - 15)))


@dataclass(frozen=True, eq=False)
class SineSum:
    """A sum of sines for each axis, at rest for the first 0.3 s."""

    height: NDArray[np.float64]
    """Amplitude of each wave, (waves, 3)."""

    pace: NDArray[np.float64]
    """Angular frequency of each wave [rad/s], (waves, 3)."""

    phase: NDArray[np.float64]
    """Phase of each wave [rad], (waves, 3)."""

    def __call__(self, time: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the vector at `time` (n,) [s], (n, 3)."""
        angle = time[:, None, None] * self.pace + self.phase
        swing = (self.height * (np.sin(angle) - np.sin(self.phase))).sum(1)
        return np.asarray(swing * minimum_jerk(time, 0.3, 0.5)[:, None])

    def scaled(self, factor: float) -> "SineSum":
        """Return the same waves, `factor` times as high."""
        return SineSum(self.height * factor, self.pace, self.phase)


def random_sines(
    random: np.random.Generator, reach: tuple[float, float, float], pace: tuple[float, float]
) -> SineSum:
    """Draw three sines for each axis, `reach` in all, with paces [rad/s] between two bounds."""
    share = random.uniform(0.5, 1.0, (3, 3)) * np.array([[1.0], [0.45], [0.25]])
    height = share / share.sum(0) * np.array(reach)
    fast = np.array([[1.0], [1.5], [2.1]]) * random.uniform(*pace, (3, 3))
    return SineSum(height, fast, random.uniform(0, 2 * np.pi, (3, 3)))


def speeds(poses: Poses, times: NDArray[np.float64]) -> NDArray[np.float64]:
    """Velocities (n, 6) at `times`: of the centre [m/s] and of turning [rad/s], camera axes."""
    step = 1e-4
    before, after = poses(times - step), poses(times + step)
    turn = Rotation.from_matrix(after[:, :3, :3] @ before[:, :3, :3].transpose(0, 2, 1))
    found = np.empty((len(times), 6))
    found[:, :3] = (after[:, :3, 3] - before[:, :3, 3]) / (2 * step)
    found[:, 3:] = turn.as_rotvec() / (2 * step)
    return found
