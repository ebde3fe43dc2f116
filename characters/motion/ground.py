"""The ground under a clip: at rest, or moving backward under a clip that walks in place.

On a treadmill the standing feet show the ground's velocity: most foot joints that are low belong to
standing feet, and move with about the same velocity.
"""

from collections import deque
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cubeling.characters.motion.clip import Clip
from cubeling.characters.skeleton import rotations
from cubeling.characters.skeleton.pose import Array, Skeleton

MAX_CONTACT_HEIGHT = 0.03
"""How far above its lowest position a foot joint may be near the ground [body heights]."""

_MIN_TREADMILL_SPEED = 0.06  # [body heights/s]; a slower treadmill is at rest
_MAX_IN_PLACE_EXTENT = 0.5  # [body heights]; a clip that goes farther is on ground at rest
_SPEED_TOLERANCE = (0.15, 0.5)  # of standing feet: [body heights/s], and parts of the speed
_TURN_REGULARISATION = 0.02  # [body heights]: feet on one spot do not define a yaw rate


@dataclass(frozen=True)
class Ground:
    """Rigid motion of the ground under a clip: at rest, a treadmill or a turntable."""

    velocity: Array
    """At the origin, (2,): x, z [m/s]."""

    yaw_rate: float
    """About +y at the origin [rad/s]."""

    def velocity_at(self, positions: Array) -> Array:
        """Return its velocity (…, 3) [m/s] at positions (…, 3).

        >>> ground = Ground(np.array([0.0, -1.0]), 1.0)
        >>> ground.velocity_at(np.array([2.0, 5.0, 0.0])).tolist()
        [0.0, 0.0, -3.0]
        """
        velocity = np.zeros(np.shape(positions))
        velocity[..., 0] = self.velocity[0] + self.yaw_rate * positions[..., 2]
        velocity[..., 2] = self.velocity[1] - self.yaw_rate * positions[..., 0]
        return velocity


FIXED_GROUND = Ground(np.zeros(2), 0.0)
"""The ground below a motion that does not travel."""


@dataclass(frozen=True)
class JointTrajectories:
    """Positions and velocities of joints in the frame of the root."""

    positions: Array
    """(frames, joints, 3) [m]."""

    velocities: Array
    """Horizontal velocities over the ground, (frames, joints, 3) [m/s]; y is 0."""

    body_height: float
    """Height of the body [m]."""


def joint_trajectories(clip: Clip, skeleton: Skeleton) -> JointTrajectories:
    """Return the trajectories of all joints; with root motion, loops are periodic in its frame.

    Those of the last clips are kept: gaits ask for them three times, for steps, feet and contacts.
    """
    for known_clip, known_skeleton, kept in tuple(_KEPT):
        if known_clip is clip and known_skeleton is skeleton:
            return kept
    _KEPT.append((clip, skeleton, _trajectories(clip, skeleton)))
    return _KEPT[-1][2]


_KEPT: deque[tuple[Clip, Skeleton, JointTrajectories]] = deque(maxlen=16)


def _trajectories(clip: Clip, skeleton: Skeleton) -> JointTrajectories:
    placed = clip.in_place if clip.root_motion else clip.poses
    positions = placed.globals(skeleton)[..., :3, 3]
    world = clip.poses.globals(skeleton)[..., :3, 3] if clip.root_motion else positions
    steps = np.diff(world, axis=0) * clip.rate
    if clip.root_motion:
        yaw = clip.track[:, 2]
        steps = rotations.rotate(rotations.about("y", -(yaw[1:] + yaw[:-1]) / 2)[:, None], steps)
    before = steps[-1:] if clip.loop else steps[:1]
    after = steps[:1] if clip.loop else steps[-1:]
    velocities = (np.concatenate([before, steps]) + np.concatenate([steps, after])) / 2
    velocities[..., 1] = 0.0
    height = float(np.median(np.ptp(positions[..., 1], axis=1)))
    return JointTrajectories(positions, velocities, max(height, 1e-9))


def find_ground(clip: Clip, tracks: JointTrajectories, joints: NDArray[np.intp]) -> Ground:
    """Return the motion of the ground under a clip, from the joints of its feet (n,).

    Most joints that are low belong to standing feet. A rigid motion is fitted repeatedly to those
    that agree with the previous fit, so clips that turn in place are handled too.
    """
    path = clip.track[:, :2] if clip.root_motion else tracks.positions.mean(1)[:, [0, 2]]
    if np.ptp(path, axis=0).max() > _MAX_IN_PLACE_EXTENT * tracks.body_height:
        return FIXED_GROUND
    heights = tracks.positions[:, joints, 1]
    low = height_above_lowest(heights) < MAX_CONTACT_HEIGHT * tracks.body_height
    positions = tracks.positions[:, joints][low][:, [0, 2]]
    velocities = tracks.velocities[:, joints][low][:, [0, 2]]
    velocity, yaw_rate = np.median(velocities, axis=0), 0.0
    absolute, relative = _SPEED_TOLERANCE
    tolerance = absolute * tracks.body_height + relative * float(np.hypot(*velocity))
    for _ in range(8):
        turning = yaw_rate * np.stack([positions[:, 1], -positions[:, 0]], axis=-1)
        inliers = np.linalg.norm(velocities - velocity - turning, axis=-1) < tolerance
        if inliers.sum() < 4:
            break
        velocity, yaw_rate = _fit_rigid(positions[inliers], velocities[inliers], tracks.body_height)
    slow = np.hypot(*velocity) < _MIN_TREADMILL_SPEED * tracks.body_height
    at_rest = slow and abs(yaw_rate) < 2 * _MIN_TREADMILL_SPEED
    return FIXED_GROUND if at_rest else Ground(velocity, yaw_rate)


def height_above_lowest(heights: Array) -> Array:
    """Return the heights of joints above their lowest positions, (frames, n), outliers aside."""
    return heights - np.quantile(heights, 0.02, axis=0)


def _fit_rigid(positions: Array, velocities: Array, body_height: float) -> tuple[Array, float]:
    """Return the velocity of the origin and the yaw rate that best fit velocities at positions."""
    centre, mean = positions.mean(0), velocities.mean(0)
    x, z = (positions - centre).T
    dx, dz = (velocities - mean).T
    inertia = (x**2 + z**2).sum() + len(x) * (_TURN_REGULARISATION * body_height) ** 2
    yaw_rate = float((z * dx - x * dz).sum() / inertia)
    return mean - yaw_rate * np.array([centre[1], -centre[0]]), yaw_rate
