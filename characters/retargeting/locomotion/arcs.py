"""Ways over the ground as arcs, and places beside them: how a straight walk becomes a curved one.

A place is told by how far along the arc it is and how far to its left. Bending the arc takes the
footprints with it: what stood still stands still, and outer feet take longer steps by themselves.
"""

from dataclasses import dataclass

import numpy as np

from characters.motion.motion import RootDelta
from characters.retargeting.ground import arc
from characters.skeleton import rotations
from characters.skeleton.pose import Array

_STRAIGHT = 1e-6  # curvatures [1/m] below this are none


@dataclass(frozen=True)
class Course:
    """An arc from the origin along +z at constant speed."""

    speed: float
    """Along the arc [m/s]."""

    yaw_rate: float
    """About +y, to the left [rad/s]."""

    @staticmethod
    def of(step: RootDelta, duration: float) -> "Course":
        """Return the course that leads along a step in a time [s], if it starts along the arc.

        >>> course = Course.of(RootDelta(2.0, 2.0, np.pi / 2), 1.0)
        >>> round(course.speed, 6), round(course.yaw_rate, 6)
        (3.141593, 1.570796)
        """
        stretch = 1.0 / float(np.sinc(step.yaw / 2 / np.pi))
        return Course(step.length * stretch / duration, step.yaw / duration)

    @property
    def curvature(self) -> float:
        """One over the radius, positive to the left [1/m]."""
        return self.yaw_rate / max(self.speed, 1e-9)

    def at(self, times: Array) -> Array:
        """Return where it is at times [s], (n, 3): x, z [m] and yaw [rad]."""
        return arc(np.array([0.0, self.speed]), self.yaw_rate, times)

    def beside(self, places: Array, times: Array) -> Array:
        """Return places (n, 3) as length along the arc, height and way to its left, (n, 3) [m].

        Lengths are those nearest to where the course is at `times`.
        """
        bend = self.curvature
        if abs(bend) < _STRAIGHT:
            return places[:, [2, 1, 0]]
        side = np.sign(bend)
        across, ahead = places[:, 0] - 1 / bend, places[:, 2]
        angle = np.arctan2(side * ahead, -side * across)
        expected = self.yaw_rate * times
        angle = expected + np.remainder(angle - expected + np.pi, 2 * np.pi) - np.pi
        left = 1 / bend - side * np.hypot(across, ahead)
        return np.stack([angle / bend, places[:, 1], left], axis=-1)

    def places(self, beside: Array) -> Array:
        """Return the places (n, 3) that `beside` tells."""
        way = arc(np.array([0.0, 1.0]), self.curvature, beside[:, 0])
        aside = np.stack([beside[:, 2], beside[:, 1], np.zeros(len(beside))], axis=-1)
        at = rotations.rotate(rotations.about("y", way[:, 2]), aside)
        at[:, [0, 2]] += way[:, :2]
        return at
