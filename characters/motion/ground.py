"""The ground under a clip: at rest, or running backward under one that walks in place.

On a treadmill the standing feet are what tells the ground's speed: most joints of feet that are low
stand, and go about as fast.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from characters.motion.clip import Clip
from characters.skeleton import rotations
from characters.skeleton.pose import Array, Skeleton

NEAR = 0.03
"""How far above its lowest a joint of a foot is taken to be near the ground [body heights]."""

_STILL = 0.06  # body heights a second: a treadmill that is slower stands still
_AWAY = 0.5  # body heights: who gets so far walks over ground that is at rest
_MARGIN = (0.15, 0.5)  # what standing feet differ by: body heights a second, parts of the speed


@dataclass(frozen=True)
class Ground:
    """How the ground moves under a clip: not at all, or like a treadmill or a turntable."""

    velocity: Array
    """At the origin, (2,): x, z [m/s]."""

    yaw_rate: float
    """About +y at the origin [rad/s]."""

    def under(self, places: Array) -> Array:
        """Return its velocity (…, 3) [m/s] under places (…, 3).

        >>> Ground(np.array([0.0, -1.0]), 1.0).under(np.array([2.0, 5.0, 0.0])).tolist()
        [0.0, 0.0, -3.0]
        """
        moved = np.zeros(np.shape(places))
        moved[..., 0] = self.velocity[0] + self.yaw_rate * places[..., 2]
        moved[..., 2] = self.velocity[1] - self.yaw_rate * places[..., 0]
        return moved


STEADY = Ground(np.zeros(2), 0.0)
"""Ground that does not move."""


@dataclass(frozen=True)
class Track:
    """Where joints go, seen from the root, and how fast over the ground."""

    places: Array
    """(frames, joints, 3) [m]."""

    speeds: Array
    """Velocities along the ground, seen so, (frames, joints, 3) [m/s]; y is nought."""

    tall: float
    """Height of the body [m]."""


def track(clip: Clip, skeleton: Skeleton) -> Track:
    """Return where all joints go; seen from the root where it moves, so that loops are periodic."""
    placed = clip.in_place if clip.root_motion else clip.poses
    places = placed.globals(skeleton)[..., :3, 3]
    world = clip.poses.globals(skeleton)[..., :3, 3] if clip.root_motion else places
    steps = np.diff(world, axis=0) * clip.rate
    if clip.root_motion:
        yaw = clip.track[:, 2]
        steps = rotations.rotate(rotations.about("y", -(yaw[1:] + yaw[:-1]) / 2)[:, None], steps)
    before = steps[-1:] if clip.loop else steps[:1]
    after = steps[:1] if clip.loop else steps[-1:]
    speeds = (np.concatenate([before, steps]) + np.concatenate([steps, after])) / 2
    speeds[..., 1] = 0.0
    tall = float(np.median(np.ptp(places[..., 1], axis=1)))
    return Track(places, speeds, max(tall, 1e-9))


def find_ground(clip: Clip, track: Track, joints: NDArray[np.intp]) -> Ground:
    """Return the ground's motion under a clip, from the joints of its feet (n,).

    Most joints that are low belong to standing feet; a rigid motion is fitted to those that move
    about as most do, and again to what that fits, so that curves in place are understood too.
    """
    way = clip.track[:, :2] if clip.root_motion else track.places.mean(1)[:, [0, 2]]
    if np.ptp(way, axis=0).max() > _AWAY * track.tall:
        return STEADY
    heights = track.places[:, joints, 1]
    low = above_lowest(heights) < NEAR * track.tall
    places = track.places[:, joints][low][:, [0, 2]]
    speeds = track.speeds[:, joints][low][:, [0, 2]]
    velocity, yaw_rate = np.median(speeds, axis=0), 0.0
    margin = _MARGIN[0] * track.tall + _MARGIN[1] * float(np.hypot(*velocity))
    for _ in range(8):
        turning = yaw_rate * np.stack([places[:, 1], -places[:, 0]], axis=-1)
        near = np.linalg.norm(speeds - velocity - turning, axis=-1) < margin
        if near.sum() < 4:
            break
        velocity, yaw_rate = _rigid(places[near], speeds[near], track.tall)
    slow = np.hypot(*velocity) < _STILL * track.tall and abs(yaw_rate) < 2 * _STILL
    return STEADY if slow else Ground(velocity, yaw_rate)


def above_lowest(heights: Array) -> Array:
    """Return how high joints are above where they go down to, (frames, n)."""
    # Single outliers apart.
    above: Array = heights - np.quantile(heights, 0.02, axis=0)
    return above


def _rigid(places: Array, speeds: Array, tall: float) -> tuple[Array, float]:
    """Return the velocity of the origin and the yaw rate that fit velocities at places best."""
    middle, mean = places.mean(0), speeds.mean(0)
    x, z = (places - middle).T
    dx, dz = (speeds - mean).T
    # A little mass is added, so that feet on one spot do not tell a yaw rate.
    mass = (x**2 + z**2).sum() + len(x) * (0.02 * tall) ** 2
    yaw_rate = float((z * dx - x * dz).sum() / mass)
    return mean - yaw_rate * np.array([middle[1], -middle[0]]), yaw_rate
