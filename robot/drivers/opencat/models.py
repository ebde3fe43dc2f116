"""The robots that run OpenCat: which joints each has, and how far they go.

Joints are numbered as on the board: head pan, head tilt, tail pan, tail tilt, four shoulder rolls,
four shoulders, four knees; the four go clockwise from the front left one, seen from behind.
"""

import math
from dataclasses import dataclass

from robot.contract.catalogue import JointLimits
from robot.drivers.opencat.tokens import ANGLE_MAX

TOP_SPEED = math.radians(240.0)
"""Taken for every servo's top speed [rad/s]. Petoi states none for the robot; its small servos are
faster without load, and no wish of ours depends on it."""


@dataclass(frozen=True)
class Joint:
    """A joint of a robot."""

    number: int
    """Its number on the board."""

    name: str
    """What it is called."""

    low: int
    """Smallest angle [deg]: the narrower one of the two firmwares' limits."""

    high: int
    """Largest angle [deg], likewise."""

    def clamped(self, angle: float) -> int:
        """Return the angle [deg] that is asked for where `angle` [deg] is wished.

        >>> Joint(1, "head tilt", -75, 40).clamped(90)
        40
        """
        low, high = max(self.low, -ANGLE_MAX), min(self.high, ANGLE_MAX)
        return min(max(round(angle), low), high)

    @property
    def limits(self) -> JointLimits:
        """The same for a catalogue."""
        return JointLimits(self.name, math.radians(self.low), math.radians(self.high), TOP_SPEED)


def _legs(
    shoulders: tuple[tuple[int, int], ...], knees: tuple[tuple[int, int], ...]
) -> list[Joint]:
    corners = ("left front", "right front", "right back", "left back")
    return [
        Joint(first + index, f"{corner} {part}", *limits[index])
        for first, part, limits in ((8, "shoulder", shoulders), (12, "knee", knees))
        for index, corner in enumerate(corners)
    ]


MODELS: dict[str, tuple[Joint, ...]] = {
    "bittle": (
        Joint(0, "head", -120, 120),
        *_legs(((-200, 80), (-200, 80), (-80, 200), (-80, 200)), ((-80, 200),) * 4),
    ),
    "nybble": (
        Joint(0, "head", -120, 120),
        Joint(1, "head tilt", -75, 40),
        Joint(2, "tail", -120, 120),
        *_legs(
            ((-100, 80), (-100, 80), (-80, 100), (-80, 100)),
            ((-60, 80), (-60, 80), (-80, 60), (-80, 60)),
        ),
    ),
    "other": (),
}
"""The models' joints by name. "other" is a board that does not say what it is, or is another robot:
it shows moods by postures alone."""


def model_of(name: str) -> str:
    """Return which of `MODELS` a board is that calls itself `name`.

    >>> model_of("Bittle X"), model_of("Nybble"), model_of("DoF16")
    ('bittle', 'nybble', 'other')
    """
    first = name.lower().split(maxsplit=1)[:1]
    return first[0] if first and first[0] in MODELS else "other"
