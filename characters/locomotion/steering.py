"""Steering of a walker to a target: how fast to go and how sharply to turn."""

import math
from itertools import accumulate
from typing import NamedTuple

import numpy as np

from cubeling.characters.locomotion.gaits import IDLE_SPEED, MAX_ANGULAR_RAD, TOP_SPEED, Gaits
from cubeling.characters.motion.motion import RootDelta
from cubeling.characters.smoothing import interpolate

ARRIVAL_DISTANCE_M = 0.05
"""Distance at which a target is reached [m on the table]."""

DEPARTURE_DISTANCE_M = 0.065
"""Distance beyond which a reached target is approached again [m on the table]."""

_STOPPING_TIME_S = 1.4  # from the fastest run; a time, because characters differ in size
_ANGULAR_PER_ERROR = 2.0  # Angular for each radian of heading error
_RADIUS_MARGIN = 1.4  # the circle to the target is so many times the turning circle
# Speeds at which turning circles are measured; at the first the walker stops.
_RADIUS_SPEEDS: list[float] = np.linspace(1.0, TOP_SPEED, 17).tolist()
_CIRCLE_SPEEDS = [IDLE_SPEED, *_RADIUS_SPEEDS]
# A turn to a target farther behind continues in the direction in which it started.
_MAX_REVERSING_ERROR = math.radians(150)


class SteeringOutput(NamedTuple):
    """Desired motion of a walker."""

    speed: float
    """AvatAR's Speed, 0…5; 0 stands."""

    angular: float
    """Turning rate [rad], −π/2…π/2; positive to the right."""

    stride: float
    """Factor of the distance over the ground, 0…1."""


STANDSTILL = SteeringOutput(0.0, 0.0, 1.0)
"""Neither goes nor turns, whatever was wished."""


def has_arrived(distance: float, arrived: bool) -> bool:
    """Return whether a target at a distance [m on the table] is reached.

    `arrived` is the last result; it gives hysteresis.

    >>> has_arrived(0.06, False), has_arrived(0.06, True)
    (False, True)
    """
    return distance < (DEPARTURE_DISTANCE_M if arrived else ARRIVAL_DISTANCE_M)


class Steering:
    """Steers a walker to a target and detects its arrival.

    `scale` is in table metres for each metre of the walker.
    """

    def __init__(self, gaits: Gaits, scale: float) -> None:
        self._gaits = gaits
        self._scale = scale
        self._circles = [gaits.radius(speed) * scale for speed in _CIRCLE_SPEEDS]
        self._radii = list(accumulate(self._circles[1:], max))
        self._arrived = False
        self._side = 1.0

    def update(
        self, place: RootDelta, target: tuple[float, float], speed: float, stop: bool
    ) -> SteeringOutput:
        """Return the motion from a place towards a target (x, z) [m], both on the table.

        `speed` is the requested Speed of AvatAR. Without `stop` the target is passed.
        """
        distance = math.hypot(target[0] - place.x, target[1] - place.z)
        self._arrived = stop and has_arrived(distance, self._arrived)
        if self._arrived or distance == 0.0:
            return STANDSTILL
        # AvatAR's Angular is positive to the right, yaw about +y is positive to the left.
        error = -place.bearing(*target)  # positive to the right
        if abs(error) < _MAX_REVERSING_ERROR:
            self._side = math.copysign(1.0, error)
        else:
            # Straight behind, noise flips the sign of the error; keep turning the way it began.
            error = self._side * abs(error)
        # Radius of the circle through the target, tangent to the heading. A target inside
        # the tightest turning circle would be orbited for ever.
        # At least 0.05: straight ahead the circle is a line, of infinite radius.
        needed = distance / (2 * max(math.sin(abs(error)), 0.05))
        speed = min(speed, self._fastest_within(needed))
        if stop:
            speed = min(speed, self._fastest_before(distance - ARRIVAL_DISTANCE_M))
        # After both limits: with less it would stand before it arrives.
        speed = max(speed, IDLE_SPEED)
        circle = interpolate(speed, _CIRCLE_SPEEDS, self._circles)
        # Where even the slowest circle is too wide, it takes shorter steps on it.
        stride = min(1.0, needed / (_RADIUS_MARGIN * circle))
        angular = min(max(_ANGULAR_PER_ERROR * error, -MAX_ANGULAR_RAD), MAX_ANGULAR_RAD)
        return SteeringOutput(speed, angular, stride)

    def _fastest_within(self, radius: float) -> float:
        """Return the largest Speed for a curve of a radius [m on the table]."""
        return interpolate(radius / _RADIUS_MARGIN, self._radii, _RADIUS_SPEEDS)

    def _fastest_before(self, distance: float) -> float:
        """Return the largest Speed from which it slows down in time over a distance."""
        ahead = max(distance, 0.0) / self._scale
        slowest = self._gaits.pace(IDLE_SPEED)
        deceleration = self._gaits.pace(TOP_SPEED) / _STOPPING_TIME_S
        # v² = v₀² + 2·a·s, backwards from the arrival.
        pace = math.sqrt(slowest**2 + 2 * deceleration * ahead)
        return self._gaits.speed(pace)
