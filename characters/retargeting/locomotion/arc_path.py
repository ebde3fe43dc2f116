"""Arcs over the ground, and coordinates along them: how a straight walk becomes a curved one.

A point has the coordinates length along the arc, height and distance to the left of it. Bending the
arc bends the footprints with it: standing feet keep standing, and outer feet take longer steps.
"""

from dataclasses import dataclass

import numpy as np

from characters.motion.motion import RootDelta
from characters.retargeting.ground_motion import arc, transform
from characters.skeleton.pose import Array

_MIN_CURVATURE = 1e-6  # [1/m]; less is straight


@dataclass(frozen=True)
class ArcPath:
    """An arc from the origin along +z at constant speed."""

    speed: float
    """Along the arc [m/s]."""

    yaw_rate: float
    """About +y, to the left [rad/s]."""

    @staticmethod
    def of(delta: RootDelta, duration: float) -> "ArcPath":
        """Return the path of a root delta in a time [s], if it starts along the arc.

        >>> path = ArcPath.of(RootDelta(2.0, 2.0, np.pi / 2), 1.0)
        >>> round(path.speed, 6), round(path.yaw_rate, 6)
        (3.141593, 1.570796)
        """
        stretch = 1.0 / float(np.sinc(delta.yaw / 2 / np.pi))
        return ArcPath(delta.length * stretch / duration, delta.yaw / duration)

    @property
    def curvature(self) -> float:
        """Inverse of the radius, positive to the left [1/m]."""
        return self.yaw_rate / max(self.speed, 1e-9)

    def at(self, times: Array) -> Array:
        """Return x, z [m] and yaw [rad] at times [s], (n, 3)."""
        return arc(np.array([0.0, self.speed]), self.yaw_rate, times)

    def to_arc(self, points: Array, times: Array) -> Array:
        """Return points (n, 3) in coordinates along the arc, (n, 3) [m].

        Of the possible lengths along the arc, the ones nearest to the path at `times` are taken.
        """
        curvature = self.curvature
        if abs(curvature) < _MIN_CURVATURE:
            return points[:, [2, 1, 0]]
        side = np.sign(curvature)
        across, ahead = points[:, 0] - 1 / curvature, points[:, 2]
        angle = np.arctan2(side * ahead, -side * across)
        expected = self.yaw_rate * times
        angle = expected + np.remainder(angle - expected + np.pi, 2 * np.pi) - np.pi
        left = 1 / curvature - side * np.hypot(across, ahead)
        return np.stack([angle / curvature, points[:, 1], left], axis=-1)

    def from_arc(self, coordinates: Array) -> Array:
        """Return the points (n, 3) of coordinates along the arc."""
        path = arc(np.array([0.0, 1.0]), self.curvature, coordinates[:, 0])
        left, height = coordinates[:, 2], coordinates[:, 1]
        return transform(path, np.stack([left, height, np.zeros(len(coordinates))], axis=-1))
