"""The robots with OpenCat: their joints and limits.

Joints have the numbers of the board: head pan, head tilt, tail pan, tail tilt, four shoulder rolls,
four shoulders, four knees; each four go clockwise from the left front, seen from behind.
"""

import math
from dataclasses import dataclass

from cubeling.robot.contract.catalogue import JointLimits
from cubeling.robot.drivers.opencat.tokens import MAX_ANGLE_DEG

ASSUMED_SPEED_DEG_PER_S = 240.0
"""Assumed top speed of every servo [°/s]: Petoi states none, and no command depends on it."""


@dataclass(frozen=True)
class OpenCatJoint:
    """A joint of a robot."""

    number: int
    """Its number on the board."""

    name: str
    """Name in the catalogue, such as "left front knee"."""

    low: int
    """Smallest angle [°]: the narrower limit of the two firmwares."""

    high: int
    """Largest angle [°]: the narrower limit of the two firmwares."""

    def clamp(self, angle: float) -> int:
        """Return an angle [°] within the limits.

        >>> OpenCatJoint(1, "head tilt", -75, 40).clamp(90)
        40
        """
        low, high = max(self.low, -MAX_ANGLE_DEG), min(self.high, MAX_ANGLE_DEG)
        return min(max(round(angle), low), high)

    @property
    def limits(self) -> JointLimits:
        """The limits in the units of a catalogue."""
        low, high, speed = map(math.radians, (self.low, self.high, ASSUMED_SPEED_DEG_PER_S))
        return JointLimits(self.name, low, high, speed)


def _legs(
    shoulders: tuple[tuple[int, int], ...], knees: tuple[tuple[int, int], ...]
) -> list[OpenCatJoint]:
    corners = ("left front", "right front", "right back", "left back")
    return [
        OpenCatJoint(first + index, f"{corner} {part}", *limits[index])
        for first, part, limits in ((8, "shoulder", shoulders), (12, "knee", knees))
        for index, corner in enumerate(corners)
    ]


MODELS: dict[str, tuple[OpenCatJoint, ...]] = {
    "bittle": (
        OpenCatJoint(0, "head", -120, 120),
        *_legs(((-200, 80), (-200, 80), (-80, 200), (-80, 200)), ((-80, 200),) * 4),
    ),
    "nybble": (
        OpenCatJoint(0, "head", -120, 120),
        OpenCatJoint(1, "head tilt", -75, 40),
        OpenCatJoint(2, "tail", -120, 120),
        *_legs(
            ((-100, 80), (-100, 80), (-80, 100), (-80, 100)),
            ((-60, 80), (-60, 80), (-80, 60), (-80, 60)),
        ),
    ),
    "other": (),
}
"""The joints of each model; "other" is any other board: it shows moods by postures alone."""


def model_of(name: str) -> str:
    """Return which of `MODELS` a board is that reports the model `name`.

    >>> model_of("Bittle X"), model_of("Nybble"), model_of("DoF16")
    ('bittle', 'nybble', 'other')
    """
    first = name.lower().split(maxsplit=1)[:1]
    return first[0] if first and first[0] in MODELS else "other"
