"""Clips mixed in step whose feet keep to the ground, however long the steps are made.

A mix of joint angles moves the feet on a path of no clip: they slide, and dip into the ground. Here
the feet of a mix go where the mean of the clips' feet is, drawn together about the place where they
stand, so that they stand still over the ground under a body that goes less far: a foot p that
stands while the body goes its way u and turns, and the same foot r of a body that only turns, make
s p + (1 − s) r stand while the body goes s u.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

from characters.locomotion.foot_trajectories import FootTrajectories
from characters.motion.motion import RootDelta
from characters.skeleton.pose import Pose
from characters.skeleton.scalar_quaternions import (
    Quaternion,
    Vector,
    conjugate,
    multiply,
    normalize,
)

_PARTS = 16  # of a cycle, in each of which the mean of several ways is taken
_LIFT = 0.3  # how high feet go rises with this power of how far they go, …
_TURNING = 1.0  # … and on the spot by so much more than that, to clear the ground


@dataclass(frozen=True)
class StrideBlend:
    """Clips mixed in step, with shorter steps and at another pace; `Cyclic`."""

    trajectories: FootTrajectories
    """What there is to mix."""

    voices: Sequence[tuple[int, float]]
    """Number of each clip that is mixed and its weight; positive, sum one."""

    share: float = 1.0
    """How long steps are and how far they turn, as a part of the clips'; the rest is the stance."""

    stride: float = 1.0
    """What is left of the way, but not of the turning, after that."""

    rate: float = 1.0
    """How much faster than the clips."""

    @property
    def duration(self) -> float:
        """Length of one cycle [s]."""
        motions = self.trajectories.motions
        return 1.0 / (sum(w / motions[n].duration for n, w in self.voices) * self.rate)

    def at(self, phase: float) -> Pose:
        """Return the mixed pose at a phase."""
        pose, feet = self.trajectories.mixed(self.voices, phase, self.share)
        if len(self.voices) == 1 and self.share == self.stride == 1.0:
            return pose
        return self.trajectories.legs.reach(pose, *self._feet(feet))

    def contacts(self, phase: float) -> list[float]:
        """Return how much of the mix has each foot on the ground, 0…1."""
        return self.trajectories.contacts(self.voices, phase)

    def between(self, start: float, end: float) -> RootDelta:
        """Return how the root moves over the ground between two phases."""
        total = RootDelta()
        parts = max(math.ceil((end - start) * _PARTS), 1)
        each = (end - start) / parts
        for low in (start + each * part for part in range(parts)):
            x = z = yaw = 0.0
            for number, weight in self.voices:
                step = self.trajectories.travel(number, low, low + each)
                x, z, yaw = x + weight * step.x, z + weight * step.z, yaw + weight * step.yaw
            way = self.share * self.stride
            total = total.then(RootDelta(x * way, z * way, yaw * self.share))
        return total

    def sample(self, time: float) -> Pose:
        """Return the mixed pose at a time [s] since phase 0."""
        return self.at(time / self.duration)

    def travel(self, start: float, end: float) -> RootDelta:
        """Return how the root moves over the ground between two times [s]."""
        duration = self.duration
        return self.between(start / duration, end / duration)

    def _feet(self, feet: Sequence[Sequence[float]]) -> tuple[list[Vector], list[Quaternion]]:
        """Return where the balls of the feet are to be and how they face.

        `feet` are ball, facing and contact of each, the mean of the clips'.
        """
        balls: list[Vector] = []
        facings: list[Quaternion] = []
        for leg, (foot, still) in enumerate(zip(feet, self.trajectories.stance.plain, strict=True)):
            homes = [
                (self.trajectories.plain_homes[number][leg], weight)
                for number, weight in self.voices
            ]
            home = [sum(h[k] * weight for h, weight in homes) for k in range(7)]
            x, y, z, *facing = foot[:7]
            if self.share < 1.0:
                higher = (y - home[1]) * self.share**_LIFT
                x, _, z, *facing = _drawn(still, foot, self.share)
                home = _drawn(still, home, self.share)
                y = home[1] + higher
            faced = normalize(facing)
            if self.stride < 1.0:
                y += (y - home[1]) * _TURNING * (1.0 - self.stride)
                x, z = self._under_a_turn(x, z, home, _twist(faced, normalize(home[3:])))
            balls.append((x, y, z))
            facings.append(faced)
        return balls, facings

    def _under_a_turn(
        self, x: float, z: float, home: Sequence[float], yaw: float
    ) -> tuple[float, float]:
        """Return x, z of a foot drawn to where it would be if the body only turned.

        Such a foot goes round the root as far as it turns itself: `yaw` [rad].
        """
        sine, cosine, less = math.sin(yaw), math.cos(yaw), 1.0 - self.stride
        return (
            x + less * (cosine * home[0] + sine * home[2] - x),
            z + less * (cosine * home[2] - sine * home[0] - z),
        )


def _drawn(still: Sequence[float], foot: Sequence[float], share: float) -> list[float]:
    """Return numbers of a foot, drawn to those of one that stands."""
    return [a + share * (b - a) for a, b in zip(still, foot, strict=False)]


def _twist(facing: Quaternion, reference: Quaternion) -> float:
    """Return how far a rotation is turned about +y from another [rad]."""
    _, y, _, w = multiply(facing, conjugate(reference))
    return math.remainder(2 * math.atan2(y, w), math.tau)
