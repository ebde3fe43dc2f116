"""What the last seen poses say about now: velocity, and where the cube should be."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tracking import se3

Array = NDArray[np.float64]

MEMORY = 0.2
"""How long a pose is carried on without being seen [s]; after that the cube may be anywhere."""

HAND_ACCELERATION = (8.0, 60.0)
"""What a hand does to a cube that it plays with, one standard deviation [m/s², rad/s²]."""

FASTEST = (4.0, 40.0)
"""Nobody moves a cube faster in front of a camera [m/s, rad/s]; what does so is another cube."""


BLUR_TIME = (8e-4, 0.013)
"""Motion blur biases a pose by its speed times this [s], and its attitude by [rad/m · s].

A tenth of a usual exposure: a cube that moves by 1 mm during it is seen 0.1 mm beside its middle.
"""


@dataclass(frozen=True)
class Sighting:
    """A trusted pose."""

    camera_from_cube: Array
    """Pose of the cube, (4, 4) [m]."""

    velocity: Array
    """As in `CubeState.velocity`, (6,)."""

    covariance: Array
    """As in `CubeState.covariance`, (6, 6)."""

    timestamp: float
    """When [s]."""


def velocity(before: Sighting | None, camera_from_cube: Array, timestamp: float) -> Array:
    """Mean velocity since the last sighting, (6,): one difference, no filter, so half a frame old.

    Zero for a first sighting, and after one so old that the cube's way since is not known.
    """
    if before is None:
        return np.zeros(6)
    elapsed = timestamp - before.timestamp
    if elapsed <= 0 or elapsed > MEMORY:
        return np.zeros(6) if elapsed > 0 else before.velocity
    return se3.motion(before.camera_from_cube, camera_from_cube) / elapsed


def blur_covariance(motion: Array) -> Array:
    """Covariance that a velocity, (6,), adds to a pose seen in motion, (6, 6)."""
    speed = float(np.sqrt(motion[:3] @ motion[:3] + (0.05**2) * (motion[3:] @ motion[3:])))
    return np.diag(np.square(speed * np.repeat(BLUR_TIME, 3)))


def predicted(last: Sighting, timestamp: float) -> Array:
    """Pose at `timestamp` if the cube keeps its velocity, (4, 4)."""
    return se3.moved(last.camera_from_cube, last.velocity * (timestamp - last.timestamp))


def predicted_covariance(last: Sighting, timestamp: float) -> Array:
    """Covariance of `predicted`, (6, 6): the hand may have accelerated ever since."""
    elapsed = timestamp - last.timestamp
    spread = np.repeat(HAND_ACCELERATION, 3) * elapsed**2 / 2
    return last.covariance * (1 + elapsed / MEMORY) ** 2 + np.diag(spread**2)


def near(last: Sighting, camera_from_cube: Array, timestamp: float) -> bool:
    """Whether a pose lies within three standard deviations of `predicted`, each way."""
    step = se3.motion(predicted(last, timestamp), camera_from_cube)
    spread = np.sqrt(np.diag(predicted_covariance(last, timestamp)))
    return bool((np.abs(step) < 3 * spread + 0.002).all())


def plausible(last: Sighting, camera_from_cube: Array, timestamp: float) -> bool:
    """Whether a hand can have brought the cube there since it was last seen."""
    elapsed = max(timestamp - last.timestamp, 0.0)
    step = se3.motion(last.camera_from_cube, camera_from_cube)
    # The constants are what a pose may be wrong by at worst, for frames that follow at once.
    return bool(
        np.linalg.norm(step[:3]) < FASTEST[0] * elapsed + 0.02
        and np.linalg.norm(step[3:]) < min(FASTEST[1] * elapsed + 0.1, np.pi + 0.1)
    )
