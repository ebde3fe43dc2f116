"""The joints of a Pleo: limits, steps and speeds.

Source: OliverHoffmann/PleoCommand (2010), firmware 1.1.
"""

import math
from dataclasses import dataclass

from cubeling.robot.contract.catalogue import JointLimits

ASSUMED_SPEED_DEG_PER_S = 50.0
"""Top speed of a joint without a published one [°/s]: about that of the joints next to it."""


@dataclass(frozen=True)
class PleoJoint:
    """One joint. Zero is neutral; positive is forward, up or right."""

    name: str
    """Name in the catalogue."""

    low: int
    """Smallest angle [°]."""

    high: int
    """Largest angle [°]."""

    step: int
    """Its angles are multiples of this [°]."""

    speed: float = ASSUMED_SPEED_DEG_PER_S
    """Top speed [°/s]."""

    @property
    def limits(self) -> JointLimits:
        """The limits in the units of a catalogue."""
        low, high, speed = map(math.radians, (self.low, self.high, self.speed))
        return JointLimits(self.name, low, high, speed)

    def nearest(self, degrees: float) -> int:
        """Return the closest angle [°] within its limits and on a step.

        >>> JOINTS[8].name, JOINTS[8].nearest(-9.2), JOINTS[8].nearest(40)
        ('torso', -10, 14)
        """
        lowest, highest = math.ceil(self.low / self.step), math.floor(self.high / self.step)
        return self.step * round(min(max(degrees / self.step, lowest), highest))

    def time(self, start: float | None, end: float) -> float:
        """Return the time from one angle to another [s]; from None, the longest possible one."""
        way = max(self.high - end, end - self.low) if start is None else abs(end - start)
        return way / self.speed


JOINTS = (
    PleoJoint("right shoulder", -30, 55, 1, 30),
    PleoJoint("right elbow", 0, 90, 1, 70),
    PleoJoint("left shoulder", -30, 55, 1, 30),
    PleoJoint("left elbow", 0, 90, 1, 70),
    PleoJoint("left hip", -45, 40, 10),
    PleoJoint("left knee", -70, 0, 2, 50),
    PleoJoint("right hip", -45, 40, 10),
    PleoJoint("right knee", -70, 0, 2, 50),
    PleoJoint("torso", -15, 15, 2, 20),
    PleoJoint("tail sideways", -90, 90, 1, 200),
    PleoJoint("tail up", -90, 90, 1, 200),
    PleoJoint("neck sideways", -65, 55, 1),
    PleoJoint("neck up", -75, 75, 1, 40),
    # One motor: 25…85 are the eyelids, −80…−30 the mouth. Sources give a step of 1 to 20.
    PleoJoint("eyes and mouth", -80, 85, 1, 220),
)
"""Every joint; its index is its number on the console."""

JOINT_NUMBERS = {joint.name: number for number, joint in enumerate(JOINTS)}
"""Number of each joint by name."""
