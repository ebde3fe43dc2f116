"""AvatAR's Speed: how fast the character goes, from the angle of the cube.

Source: A. Fernández-Baena (2015), *Animation and Interaction of Responsive, Expressive, and
Tangible 3D Virtual Characters*, section 5.2.4.
"""

import math
from collections.abc import Callable

SpeedMap = Callable[[float], float]
"""From the angle between camera and cube [rad], 0…π, to Speed, 0…5."""

IDLE_MAX_ANGLE = math.radians(45)
"""Up to this angle the idle face is towards the camera [rad]."""

WALK_MAX_ANGLE = math.radians(135)
"""Up to this angle a walk face is [rad]."""

START_HYSTERESIS = math.radians(5)
"""How far beyond `IDLE_MAX_ANGLE` the cube must turn before the character starts to move [rad]."""

SMOOTHING_TIME_S = 0.15
"""Time constant of the Speed."""

MIN_STOPPING_SPEED = 0.05
"""A Speed below this becomes 0 when the cube is at idle."""


def corrected_speed(angle: float) -> float:
    """Return a Speed that is continuous except for the step at 45°, and runs only on the run face.

    The printed map starts to run at 65° and leaves the declared range beyond 155°. This one
    keeps the declared limits: walking is from 0.5 to 3, and 5 is the maximum.

    >>> [round(corrected_speed(math.radians(d)), 2) for d in (0, 45, 90, 135, 180)]
    [0.0, 0.0, 1.75, 3.0, 5.0]
    """
    if angle <= IDLE_MAX_ANGLE:
        return 0.0
    if angle <= WALK_MAX_ANGLE:
        return 0.5 + 2.5 * (angle - IDLE_MAX_ANGLE) / (WALK_MAX_ANGLE - IDLE_MAX_ANGLE)
    return min(5.0, 3.0 + 2.0 * (angle - WALK_MAX_ANGLE) / (math.pi - WALK_MAX_ANGLE))


def legacy(angle: float) -> float:
    """Return the Speed as printed in the thesis: 0 up to 45°, then [0°, 180°] onto [1.55, 5.55].

    >>> [round(legacy(math.radians(d)), 2) for d in (45, 90, 180)]
    [0.0, 3.55, 5.55]
    """
    return 0.0 if angle <= IDLE_MAX_ANGLE else 1.55 + 4.0 * angle / math.pi


SPEED_MAPS: dict[str, SpeedMap] = {"corrected": corrected_speed, "legacy": legacy}
"""The maps by name."""


class SpeedDial:
    """Turns the cube's angle into a Speed, without flicker at the step and without jitter.

    Leaving idle needs 5° more than the map says, and the Speed is smoothed over 0.15 s
    (both as specified in M10). Standing is exactly 0.
    """

    def __init__(self, name: str = "corrected") -> None:
        self.use(name)
        self._moving = False
        self._speed = 0.0
        self._last: float | None = None

    def use(self, name: str) -> None:
        """Use a map of `SPEED_MAPS` from now on."""
        self._map = SPEED_MAPS[name]

    def update(self, angle: float, timestamp: float) -> float:
        """Return the Speed for one frame, from the angle between camera and cube [rad]."""
        if self._moving:
            self._moving = angle > IDLE_MAX_ANGLE
        else:
            self._moving = angle > IDLE_MAX_ANGLE + START_HYSTERESIS
        target = self._map(angle) if self._moving else 0.0
        elapsed = 0.0 if self._last is None else max(0.0, timestamp - self._last)
        self._last = timestamp
        self._speed += (target - self._speed) * (1.0 - math.exp(-elapsed / SMOOTHING_TIME_S))
        if not self._moving and self._speed < MIN_STOPPING_SPEED:
            self._speed = 0.0
        return self._speed
