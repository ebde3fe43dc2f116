"""What the last seen poses say about now: velocity, and where the cube should be."""

from collections import deque
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from tracking.geometry import se3

Array = NDArray[np.float64]

MEMORY = 0.2
"""How long a pose is carried on without being seen [s]; after that the cube may be anywhere."""

HAND_ACCELERATION = (8.0, 60.0)
"""What a hand does to a cube that it plays with, one standard deviation [m/s², rad/s²]."""

FASTEST = (4.0, 40.0)
"""Nobody moves a cube faster in front of a camera [m/s, rad/s]; what does so is another cube."""


TRUST, NOISE = 0.85, 2.0
"""Share of a clear acceleration that is carried on, and how much clearer than noise it must be."""

LASTING = 0.07
"""A hand does not accelerate the same way for longer than this [s]."""


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

    acceleration: Array = field(default_factory=lambda: np.zeros(6))
    """How the velocity changes, as far as the poses tell, (6,) [m/s², rad/s²]."""


class Track:
    """The last trusted poses of one cube, and what follows from them."""

    def __init__(self) -> None:
        self._sightings: deque[Sighting] = deque(maxlen=3)

    @property
    def last(self) -> Sighting | None:
        """The latest sighting, however old."""
        return self._sightings[-1] if self._sightings else None

    def recent(self, timestamp: float) -> Sighting | None:
        """Return the latest sighting, if it is not too old to tell where the cube is."""
        last = self.last
        return last if last and 0 <= timestamp - last.timestamp <= MEMORY else None

    def add(self, sighting: Sighting) -> None:
        """Remember a trusted pose."""
        self._sightings.append(sighting)

    def restart(self, sighting: Sighting) -> None:
        """Forget the way so far: the cube has jumped."""
        self._sightings.clear()
        self._sightings.append(sighting)

    def motion(
        self, camera_from_cube: Array, covariance: Array, timestamp: float
    ) -> tuple[Array, Array]:
        """Velocity and acceleration at a new pose, (6,) each: of the parabola through three poses.

        A plain difference would be the velocity of half a frame ago. The acceleration counts only
        as far as it stands out from the noise of the poses (Wiener, 1949), each axis by itself: so
        a cube at rest stays at rest. Zero after a pause so long that the way is not known.
        """
        still = np.zeros(6)
        last = self.last
        if last is None:
            return still, still
        elapsed = timestamp - last.timestamp
        if elapsed <= 0 or elapsed > MEMORY:
            return (still, still) if elapsed > 0 else (last.velocity, last.acceleration)
        now = se3.motion(last.camera_from_cube, camera_from_cube) / elapsed
        earlier = self._sightings[-2] if len(self._sightings) > 1 else None
        before = last.timestamp - earlier.timestamp if earlier else 0.0
        if earlier is None or not 0 < before <= MEMORY:
            return now, still
        mean = se3.motion(earlier.camera_from_cube, last.camera_from_cube) / before
        span = (elapsed + before) / 2
        change = (now - mean) / span
        variances = (np.diag(covariance) + np.diag(last.covariance)) / elapsed**2
        variances += (np.diag(earlier.covariance) + np.diag(last.covariance)) / before**2
        noise = NOISE * variances / span**2
        change *= TRUST * change**2 / (change**2 + noise)
        return now + change * elapsed / 2, change


def predicted(last: Sighting, timestamp: float) -> Array:
    """Pose at `timestamp` if the cube goes on as it does, (4, 4)."""
    ahead = timestamp - last.timestamp
    bend = np.clip(ahead, -LASTING, LASTING) ** 2 / 2
    return se3.moved(last.camera_from_cube, last.velocity * ahead + last.acceleration * bend)


def velocity_at(last: Sighting, timestamp: float) -> Array:
    """Velocity at `timestamp` if the cube goes on as it does, (6,)."""
    ahead = np.clip(timestamp - last.timestamp, -LASTING, LASTING)
    return np.asarray(last.velocity + last.acceleration * ahead, np.float64)


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
