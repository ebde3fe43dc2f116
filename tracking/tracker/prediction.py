"""The track of one cube: its last trusted poses, its velocity, and where it should be now."""

from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from cubeling.tracking.geometry import se3
from cubeling.tracking.geometry.arrays import Array

MAX_PREDICTION_S = 0.2
"""A pose is extrapolated for this long at most; after that the cube may be anywhere."""

HAND_ACCELERATION = (8.0, 60.0)
"""Acceleration of a cube in a playing hand, one standard deviation [m/s², rad/s²]."""

MAX_SPEED = (4.0, 40.0)
"""No hand moves a cube faster in front of a camera [m/s, rad/s]."""

MAX_ACCELERATION_SHARE, NOISE_FACTOR = 0.85, 2.0
"""Share of a clear acceleration that is extrapolated, and the weight of its noise against it."""

MAX_ACCELERATION_S = 0.07
"""A hand does not accelerate in the same direction for longer than this."""

PREDICTION_TOLERANCE = 0.002
"""A pose may be so much further from where it is expected than its covariance says, along and about
each axis [m, rad]."""


@dataclass(frozen=True)
class TrackedPose:
    """A trusted pose of the past."""

    camera_from_cube: Array
    """Pose of the cube, (4, 4) [m]."""

    velocity: Array
    """As in `CubeState.velocity`, (6,)."""

    covariance: Array
    """As in `Candidate.covariance`, (6, 6): what differs from frame to frame."""

    timestamp: float
    """When [s]."""

    acceleration: Array = field(default_factory=lambda: np.zeros(6))
    """Estimated change of the velocity, (6,) [m/s², rad/s²]."""

    systematic: Array = field(default_factory=lambda: np.zeros((6, 6)))
    """Covariance of the errors that all frames have in common, (6, 6)."""

    def reaches(self, camera_from_cube: Array, timestamp: float) -> bool:
        """Whether a hand can have moved the cube from here to another pose by `timestamp`."""
        elapsed = max(timestamp - self.timestamp, 0.0)
        delta = se3.delta(self.camera_from_cube, camera_from_cube)
        # The constants are the worst errors of a pose, for frames that follow at once.
        return bool(
            np.linalg.norm(delta[:3]) < MAX_SPEED[0] * elapsed + 0.02
            and np.linalg.norm(delta[3:]) < min(MAX_SPEED[1] * elapsed + 0.1, np.pi + 0.1)
        )


@dataclass(frozen=True)
class Prediction:
    """Where the cube should be at one moment, if it goes on as before."""

    camera_from_cube: Array
    """Expected pose, (4, 4) [m]."""

    velocity: Array
    """Expected velocity, (6,) [m/s, rad/s]."""

    covariance: Array
    """Of the expected pose, (6, 6): the hand may have accelerated since the last pose."""

    timestamp: float
    """The moment [s]."""

    systematic: Array
    """As in `TrackedPose.systematic`, of the last pose, (6, 6)."""

    def covers(self, camera_from_cube: Array) -> bool:
        """Whether a pose lies within three standard deviations and a tolerance, for each axis."""
        delta = se3.delta(self.camera_from_cube, camera_from_cube)
        allowed = 3 * np.sqrt(np.diag(self.covariance)) + PREDICTION_TOLERANCE
        return bool((np.abs(delta) < allowed).all())


@dataclass(frozen=True)
class Track:
    """The last trusted poses of one cube."""

    poses: tuple[TrackedPose, ...] = ()
    """At most two, the latest one last."""

    def add(self, pose: TrackedPose) -> "Track":
        """Return the track with one more pose."""
        return Track((*self.poses[-1:], pose))

    def predict(self, timestamp: float) -> Prediction | None:
        """Extrapolate the last pose; None where there is none, or it is too old."""
        if not self.poses:
            return None
        last = self.poses[-1]
        ahead = timestamp - last.timestamp
        if not 0 <= ahead <= MAX_PREDICTION_S:
            return None
        accelerated = min(ahead, MAX_ACCELERATION_S)
        delta = last.velocity * ahead
        delta += last.acceleration * (accelerated * (ahead - accelerated / 2))
        spread = np.repeat(HAND_ACCELERATION, 3) * ahead**2 / 2
        return Prediction(
            se3.apply_delta(last.camera_from_cube, delta),
            np.asarray(last.velocity + last.acceleration * accelerated, np.float64),
            last.covariance * (1 + ahead / MAX_PREDICTION_S) ** 2 + np.diag(spread**2),
            timestamp,
            last.systematic,
        )

    def motion(
        self, camera_from_cube: Array, covariance: Array, timestamp: float
    ) -> tuple[Array, Array]:
        """Return velocity and acceleration at a new pose, (6,) each.

        They are those of the parabola through this pose and the last two. The acceleration counts
        only as far as it exceeds the noise of the poses (Wiener, 1949), each axis by itself. Both
        are zero after a pause longer than `MAX_PREDICTION_S`.
        """
        still = np.zeros(6)
        if not self.poses:
            return still, still
        last = self.poses[-1]
        elapsed = timestamp - last.timestamp
        if elapsed <= 0:
            return last.velocity, last.acceleration
        if elapsed > MAX_PREDICTION_S:
            return still, still
        now = se3.delta(last.camera_from_cube, camera_from_cube) / elapsed
        if self._last_step is None:
            return now, still
        before, mean, variances_before = self._last_step
        span = (elapsed + before) / 2
        acceleration = (now - mean) / span
        variances = (covariance.diagonal() + last.covariance.diagonal()) / elapsed**2
        noise = NOISE_FACTOR * (variances + variances_before) / span**2
        acceleration *= MAX_ACCELERATION_SHARE * acceleration**2 / (acceleration**2 + noise)
        return now + acceleration * elapsed / 2, acceleration

    @cached_property
    def _last_step(self) -> tuple[float, Array, Array] | None:
        """The time between the last two poses [s], the mean velocity and its variances, (6,) each.

        None where there are no two, or the pause is too long.
        """
        if len(self.poses) < 2:
            return None
        earlier, last = self.poses[-2:]
        elapsed = last.timestamp - earlier.timestamp
        if not 0 < elapsed <= MAX_PREDICTION_S:
            return None
        mean = se3.delta(earlier.camera_from_cube, last.camera_from_cube) / elapsed
        variances = earlier.covariance.diagonal() + last.covariance.diagonal()
        return elapsed, mean, variances / elapsed**2
