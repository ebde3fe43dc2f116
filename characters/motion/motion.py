"""What everything that moves a character has in common, and steps over the ground."""

import math
from dataclasses import dataclass
from typing import Protocol, runtime_checkable

from characters.skeleton.pose import Pose
from characters.skeleton.rotations import wrap


@dataclass(frozen=True)
class RootDelta:
    """A planar motion over the ground, in the frame that it starts from."""

    x: float = 0.0
    """To the character's left [m]."""

    z: float = 0.0
    """Forward [m]."""

    yaw: float = 0.0
    """About +y, to the left [rad]; not wrapped."""

    def then(self, other: "RootDelta") -> "RootDelta":
        """Return this step followed by another, which starts where this one ends.

        >>> quarter = RootDelta(z=1.0, yaw=math.pi / 2)
        >>> end = quarter.then(quarter)
        >>> round(end.x, 6), round(end.z, 6), round(end.yaw / math.pi, 6)
        (1.0, 1.0, 1.0)
        """
        sine, cosine = math.sin(self.yaw), math.cos(self.yaw)
        return RootDelta(
            self.x + cosine * other.x + sine * other.z,
            self.z - sine * other.x + cosine * other.z,
            self.yaw + other.yaw,
        )

    def inverse(self) -> "RootDelta":
        """Return the step back.

        >>> step = RootDelta(1.0, 2.0, 0.5)
        >>> back = step.then(step.inverse())
        >>> round(back.x, 9) == round(back.z, 9) == round(back.yaw, 9) == 0
        True
        """
        sine, cosine = math.sin(self.yaw), math.cos(self.yaw)
        return RootDelta(
            -cosine * self.x + sine * self.z, -sine * self.x - cosine * self.z, -self.yaw
        )

    def to(self, other: "RootDelta") -> "RootDelta":
        """Return the step from this place to another, both seen from one frame.

        >>> here, there = RootDelta(1.0, 2.0, 0.5), RootDelta(4.0, 3.0, -0.4)
        >>> again = here.then(here.to(there))
        >>> round(again.x, 9), round(again.z, 9), round(again.yaw, 9)
        (4.0, 3.0, -0.4)
        """
        sine, cosine = math.sin(self.yaw), math.cos(self.yaw)
        x, z = other.x - self.x, other.z - self.z
        return RootDelta(cosine * x - sine * z, sine * x + cosine * z, other.yaw - self.yaw)

    def scaled(self, factor: float) -> "RootDelta":
        """Return the step with every component multiplied."""
        return RootDelta(self.x * factor, self.z * factor, self.yaw * factor)

    def repeated(self, times: int) -> "RootDelta":
        """Return the step taken a whole number of times, backwards too, in closed form.

        >>> square = RootDelta(z=1.0, yaw=math.pi / 2).repeated(4)
        >>> round(square.length, 9), round(square.yaw / math.pi, 9)
        (0.0, 2.0)
        """
        if times == 0:
            return RootDelta()
        half = self.yaw / 2
        # A chord of a polygon: the ratio of sines, by l'Hôpital where it is straight.
        ratio = times * math.cos(times * half) / math.cos(half)
        if abs(math.sin(half)) > 1e-9:
            ratio = math.sin(times * half) / math.sin(half)
        turned = RootDelta(yaw=(times - 1) * half).then(RootDelta(self.x * ratio, self.z * ratio))
        return RootDelta(turned.x, turned.z, times * self.yaw)

    @property
    def length(self) -> float:
        """Distance between its ends [m]."""
        return math.hypot(self.x, self.z)

    def bearing(self, x: float, z: float) -> float:
        """Return the angle [rad] from this frame's forward to the point (x, z); left is positive.

        >>> round(RootDelta(yaw=math.pi / 2).bearing(0.0, 5.0) / math.pi, 6)
        -0.5
        """
        return wrap(math.atan2(x - self.x, z - self.z) - self.yaw)


@runtime_checkable
class Motion(Protocol):
    """Something that can be played: a clip, a blend of motions, a generator of idle motion.

    Motions nest: a blend is made of motions and is one.
    """

    @property
    def duration(self) -> float:
        """Time until it repeats or ends [s]."""
        ...

    def sample(self, time: float) -> Pose:
        """Return the pose at a time [s] since its start.

        What the root does over the ground is not in the pose; it is in `travel`.
        """
        ...

    def travel(self, start: float, end: float) -> RootDelta:
        """Return how the root moves over the ground between two times [s], start ≤ end."""
        ...
