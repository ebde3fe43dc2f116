"""How to get to a place: how fast to go, how sharply to turn."""

import math
from dataclasses import dataclass
from itertools import accumulate

import numpy as np

from characters.locomotion.gaits import IDLE_SPEED, MAX_ANGULAR_RAD, TOP_SPEED, Gaits
from characters.motion.motion import RootDelta
from characters.smoothing import interpolate

ARRIVAL_DISTANCE_M = 0.05
"""Distance at which a target counts as reached [m on the table]."""

DEPARTURE_DISTANCE_M = 0.065
"""A target that was reached is left again only beyond this distance [m on the table]."""

_BRAKING = 1.4  # [s]: how long it would take to stop from its fastest run, by the brakes it uses;
# a time, for characters are of any size, and in any unit
_EAGERNESS = 2.0  # Angular for each radian between where it looks and where it wants to go
_ROOM = 1.4  # how much larger than needed the turning circle is kept away from the target
_LADDER: list[float] = np.linspace(
    1.0, TOP_SPEED, 17
).tolist()  # Speeds whose turning circles are measured,
_SPEEDS = [IDLE_SPEED, *_LADDER]  # and that at which it stops
_BEHIND = math.radians(150)  # a target farther behind is turned to the way round already begun


@dataclass(frozen=True)
class SteeringOutput:
    """What steering asks of the legs."""

    speed: float
    """AvatAR's Speed, 0…5; 0 to stand."""

    angular: float
    """How sharply to turn [rad], −π/2…π/2; positive to the right."""

    stride: float
    """What the way over the ground is to be multiplied with, 0…1."""


STANDSTILL = SteeringOutput(0.0, 0.0, 1.0)
"""To stand."""


class Steering:
    """Steers a walker to a target and knows when it is there.

    Parameters
    ----------
    gaits
        How the walker can go.
    scale
        Table metres for each metre of the walker.
    """

    def __init__(self, gaits: Gaits, scale: float) -> None:
        self._gaits = gaits
        self._scale = scale
        self._circles = [gaits.radius(speed) * scale for speed in _SPEEDS]
        self._radii = list(accumulate(self._circles[1:], max))
        self._arrived = False
        self._side = 1.0

    def course(
        self, place: RootDelta, target: tuple[float, float], speed: float, stop: bool
    ) -> SteeringOutput:
        """Return the course from a place to a target, both on the table.

        Parameters
        ----------
        place
            Where the walker stands [m] and where it looks.
        target
            x, z [m].
        speed
            AvatAR's Speed that is asked for.
        stop
            Whether to stop there, or only to pass.
        """
        distance = math.hypot(target[0] - place.x, target[1] - place.z)
        self._arrived = stop and distance < (
            DEPARTURE_DISTANCE_M if self._arrived else ARRIVAL_DISTANCE_M
        )
        if self._arrived or distance == 0.0:
            return STANDSTILL
        error = -place.bearing(*target)  # positive to the right
        if abs(error) < _BEHIND:
            self._side = math.copysign(1.0, error)
        else:
            error = self._side * abs(error)
        # The radius of the circle through the target that starts the way it looks. A target
        # inside the tightest turning circle would be orbited for ever.
        needed = distance / (2 * max(math.sin(abs(error)), 0.05))
        speed = min(speed, self._fastest_within(needed))
        if stop:
            speed = min(speed, self._fastest_before(distance - ARRIVAL_DISTANCE_M))
        speed = max(speed, IDLE_SPEED)
        circle = interpolate(speed, _SPEEDS, self._circles)
        stride = min(1.0, needed / (_ROOM * circle))
        angular = min(max(_EAGERNESS * error, -MAX_ANGULAR_RAD), MAX_ANGULAR_RAD)
        return SteeringOutput(speed, angular, stride)

    def _fastest_within(self, radius: float) -> float:
        """Return the Speed at which a curve of that radius [m on the table] can still be run."""
        return interpolate(radius / _ROOM, self._radii, _LADDER)

    def _fastest_before(self, distance: float) -> float:
        """Return the Speed from which it can slow down to a stroll over a distance."""
        ahead = max(distance, 0.0) / self._scale
        stroll = self._gaits.pace(IDLE_SPEED)
        brakes = self._gaits.pace(TOP_SPEED) / _BRAKING
        pace = math.sqrt(stroll**2 + 2 * brakes * ahead)
        return self._gaits.speed(pace)
