"""AvatAR's Speed: how fast the character goes, from how the cube is turned.

Source: A. Fernández-Baena (2015), *Animation and Interaction of Responsive, Expressive, and
Tangible 3D Virtual Characters*, section 5.2.4.
"""

import math
from collections.abc import Callable

SpeedMap = Callable[[float], float]
"""From the angle between camera and cube [rad], 0…π, to Speed, 0…5."""

STILL = math.radians(45)
"""Up to this angle the idle face looks at the camera."""

WALK = math.radians(135)
"""Up to this angle a walk face does."""


def corrected(angle: float) -> float:
    """Speed that is continuous but for the step at 45°, and runs only on the run face.

    The printed map starts to run at 65° and leaves the declared range beyond 155°;
    this one keeps the declared limits: 0.5 and 3 bound walking, 5 is the greatest.

    >>> [round(corrected(math.radians(d)), 2) for d in (0, 45, 90, 135, 180)]
    [0.0, 0.0, 1.75, 3.0, 5.0]
    """
    if angle <= STILL:
        return 0.0
    if angle <= WALK:
        return 0.5 + 2.5 * (angle - STILL) / (WALK - STILL)
    return min(5.0, 3.0 + 2.0 * (angle - WALK) / (math.pi - WALK))


def legacy(angle: float) -> float:
    """Speed as printed in the thesis: 0 up to 45°, then [0°, 180°] onto [1.55, 5.55].

    >>> [round(legacy(math.radians(d)), 2) for d in (45, 90, 180)]
    [0.0, 3.55, 5.55]
    """
    return 0.0 if angle <= STILL else 1.55 + 4.0 * angle / math.pi


MAPS: dict[str, SpeedMap] = {"corrected": corrected, "legacy": legacy}
"""The maps by name."""


class SpeedDial:
    """Speed from the cube's angle, without flicker at the step and without jitter.

    Leaving idle needs 5° more than the map says, and the Speed is smoothed over 0.15 s
    (both by the specification, M10); standing still is exact.
    """

    def __init__(self, name: str = "corrected") -> None:
        self._map = MAPS[name]
        self._moving = False
        self._speed = 0.0
        self._then: float | None = None

    def update(self, angle: float, timestamp: float) -> float:
        """Return the Speed for one frame, from the angle between camera and cube [rad]."""
        if self._moving:
            self._moving = angle > STILL
        else:
            self._moving = angle > STILL + HYSTERESIS
        wanted = self._map(angle) if self._moving else 0.0
        elapsed = 0.0 if self._then is None else max(0.0, timestamp - self._then)
        self._then = timestamp
        self._speed += (wanted - self._speed) * (1.0 - math.exp(-elapsed / SMOOTHING))
        if not self._moving and self._speed < 0.05:
            self._speed = 0.0
        return self._speed


HYSTERESIS = math.radians(5)
"""How far beyond the idle face the cube must turn before the character sets off."""

SMOOTHING = 0.15
"""Time constant of the Speed [s]."""
