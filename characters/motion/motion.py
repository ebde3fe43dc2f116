"""The protocol of all motions, and deltas of the root over the ground.

A mix moves at each moment with the weighted mean of its members' velocities, each in its own frame.
Means are therefore taken of twists (the constant velocities along a delta), not of the deltas' end
points: the mean of two arcs is an arc, and the deltas of parts compose to the delta of the whole.
"""

import math
from collections.abc import Callable, Sequence
from typing import NamedTuple, Protocol, runtime_checkable

from cubeling.affect import Emotion
from cubeling.characters.skeleton.pose import Pose
from cubeling.characters.skeleton.rotations import wrap

_WEIGHT_INTERVAL_S = 1 / 60  # varying weights are constant within such an interval
_MAX_ARC_RAD = 3.0  # a larger turn is not described by a single arc


class RootDelta(NamedTuple):
    """A planar rigid motion of the root over the ground, in the frame that it starts from.

    `RootDelta()` is no movement. A place on the ground is the delta from the origin to it.
    """

    x: float = 0.0
    """To the character's left [m]."""

    z: float = 0.0
    """Forward [m]."""

    yaw: float = 0.0
    """About +y, to the left [rad]; not wrapped."""

    @staticmethod
    def from_twist(x: float, z: float, yaw: float) -> "RootDelta":
        """Return the delta along a constant velocity in one unit of time: the inverse of `twist`.

        >>> delta = RootDelta.from_twist(*RootDelta(0.3, 1.0, 0.5).twist())
        >>> round(delta.x, 9), round(delta.z, 9), delta.yaw
        (0.3, 1.0, 0.5)
        """
        half = max(-_MAX_ARC_RAD, min(yaw, _MAX_ARC_RAD)) / 2
        stretch = math.sin(half) / half if abs(half) > 1e-9 else 1.0
        sine, cosine = math.sin(half) * stretch, math.cos(half) * stretch
        return RootDelta(cosine * x + sine * z, cosine * z - sine * x, yaw)

    def twist(self) -> tuple[float, float, float]:
        """Return the constant velocity (x, z, yaw) that covers the delta in one unit of time.

        >>> [round(v, 6) for v in RootDelta(2.0, 2.0, math.pi / 2).twist()]
        [0.0, 3.141593, 1.570796]
        """
        half = max(-_MAX_ARC_RAD, min(self.yaw, _MAX_ARC_RAD)) / 2
        stretch = half / math.sin(half) if abs(half) > 1e-9 else 1.0
        # The chord of an arc is turned by half the arc's angle from its start.
        sine, cosine = math.sin(half) * stretch, math.cos(half) * stretch
        return cosine * self.x - sine * self.z, sine * self.x + cosine * self.z, self.yaw

    def then(self, other: "RootDelta") -> "RootDelta":
        """Return this delta followed by another, which starts where this one ends.

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
        """Return the delta back.

        >>> delta = RootDelta(1.0, 2.0, 0.5)
        >>> back = delta.then(delta.inverse())
        >>> round(back.x, 9) == round(back.z, 9) == round(back.yaw, 9) == 0
        True
        """
        sine, cosine = math.sin(self.yaw), math.cos(self.yaw)
        return RootDelta(
            -cosine * self.x + sine * self.z, -sine * self.x - cosine * self.z, -self.yaw
        )

    def to(self, other: "RootDelta") -> "RootDelta":
        """Return the delta from this place to another; both are given in one frame.

        >>> here, there = RootDelta(1.0, 2.0, 0.5), RootDelta(4.0, 3.0, -0.4)
        >>> again = here.then(here.to(there))
        >>> round(again.x, 9), round(again.z, 9), round(again.yaw, 9)
        (4.0, 3.0, -0.4)
        """
        sine, cosine = math.sin(self.yaw), math.cos(self.yaw)
        x, z = other.x - self.x, other.z - self.z
        return RootDelta(cosine * x - sine * z, sine * x + cosine * z, other.yaw - self.yaw)

    def interpolate(self, other: "RootDelta", u: float) -> "RootDelta":
        """Return the place a fraction u of the way to another, along a line."""
        return RootDelta(
            self.x + (other.x - self.x) * u,
            self.z + (other.z - self.z) * u,
            self.yaw + (other.yaw - self.yaw) * u,
        )

    def repeat(self, times: int) -> "RootDelta":
        """Return the delta composed with itself a whole number of times, in closed form.

        A negative number goes backward.

        >>> square = RootDelta(z=1.0, yaw=math.pi / 2).repeat(4)
        >>> round(square.length, 9), round(square.yaw / math.pi, 9)
        (0.0, 2.0)
        """
        if times == 0:
            return RootDelta()
        half = self.yaw / 2
        # A chord of a polygon: the ratio of sines, or its limit by l'Hôpital.
        ratio = times * math.cos(times * half) / math.cos(half)
        if abs(math.sin(half)) > 1e-9:
            ratio = math.sin(times * half) / math.sin(half)
        turned = RootDelta(yaw=(times - 1) * half).then(RootDelta(self.x * ratio, self.z * ratio))
        return RootDelta(turned.x, turned.z, times * self.yaw)

    def scale(self, factor: float) -> "RootDelta":
        """Return the delta over a distance multiplied by a factor, with the same turn."""
        return RootDelta(self.x * factor, self.z * factor, self.yaw)

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


def mean_delta(deltas: Sequence[RootDelta], weights: Sequence[float]) -> RootDelta:
    """Return the mean of simultaneous deltas; the weights sum to one.

    >>> mean_delta([RootDelta(0.0, 1.0), RootDelta(0.0, 3.0)], [0.25, 0.75])
    RootDelta(x=0.0, z=2.5, yaw=0.0)
    """
    if len(deltas) == 1 and weights[0] == 1.0:
        return deltas[0]
    x = z = yaw = 0.0
    for delta, weight in zip(deltas, weights, strict=True):
        dx, dz, turn = delta.twist()
        x, z, yaw = x + weight * dx, z + weight * dz, yaw + weight * turn
    return RootDelta.from_twist(x, z, yaw)


def integrate_travel(
    start: float, end: float, travel: Callable[[float, float, float], RootDelta]
) -> RootDelta:
    """Return the root's delta between two times [s], start ≤ end, of a mix whose weights vary.

    `travel` is called with the ends of a short interval and the time of the weights in it. These
    times lie on a fixed grid, so the result does not depend on how start…end is split into parts.
    """
    total = RootDelta()
    first, last = (math.floor(time / _WEIGHT_INTERVAL_S) for time in (start, end))
    for cell in range(first, last + 1):
        low = max(start, cell * _WEIGHT_INTERVAL_S)
        high = min(end, (cell + 1) * _WEIGHT_INTERVAL_S)
        if high > low:
            total = total.then(travel(low, high, (cell + 0.5) * _WEIGHT_INTERVAL_S))
    return total


@runtime_checkable
class Motion(Protocol):
    """Something that can be played: a clip, a blend of motions, a generator of idle motion.

    Motions nest: a blend consists of motions and is one.
    """

    @property
    def duration(self) -> float:
        """Time until it repeats or ends [s]; infinite without an end."""
        ...

    def sample(self, time: float) -> Pose:
        """Return the pose at a time [s] since its start, without the root motion of `travel`."""
        ...

    def travel(self, start: float, end: float) -> RootDelta:
        """Return how the root moves over the ground between two times [s], start ≤ end."""
        ...


@runtime_checkable
class StandingMotion(Motion, Protocol):
    """What a character stands with: a motion without an end that shows an emotion."""

    def feel(self, emotion: Emotion | None) -> None:
        """Show an emotion from now on, or none."""
        ...

    def talk(self, shift: bool | None) -> None:
        """Shift the weight when a speech asks for it, or not until then; None in silence."""
        ...

    def await_act(self, first: Pose | None, within: float) -> None:
        """Go to the pose in which an act begins, be there in so many seconds, and wait.

        Without a pose it may rest in any, as only arms and head will act.
        """
        ...

    def go_on(self) -> None:
        """Shift the weight again after `await_act`."""
        ...
