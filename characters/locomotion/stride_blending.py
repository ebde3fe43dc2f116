"""Blends of clips at one phase whose standing feet do not slide, at any stride length.

A mix of joint angles moves the feet along a path that belongs to no clip: they slide. Here the feet
follow the weighted mean of the clips' feet. For shorter strides they are also drawn towards the
place where they stand: if p is a standing foot of a body that moves by u and turns, and r the same
foot of a body that only turns, then s p + (1 − s) r stands still under a body that moves by s u.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

from cubeling.characters.locomotion.foot_trajectories import FootTrajectories
from cubeling.characters.motion.motion import RootDelta
from cubeling.characters.motion.phase import PhaseDriven
from cubeling.characters.skeleton.pose import Pose
from cubeling.characters.skeleton.scalar_quaternions import (
    Quaternion,
    Vector,
    conjugate,
    multiply,
    normalize,
)

_PARTS_PER_CYCLE = 16  # intervals for the mean of root deltas
_HEIGHT_EXPONENT = 0.3  # the height of a step grows with this power of its length
_TURNING_EXTRA_HEIGHT = 1.0  # relative extra height when turning in place, to clear the ground


@dataclass(frozen=True)
class StrideBlend(PhaseDriven):
    """Clips mixed at one phase, with shorter strides and at another speed; `Cyclic`."""

    trajectories: FootTrajectories
    """Paths of the feet in each blended clip."""

    contributions: Sequence[tuple[int, float]]
    """Numbers of the mixed clips and their weights; positive, sum one."""

    share: float = 1.0
    """Factor of distance and turning, 0…1; the pose is mixed with the stance accordingly."""

    stride: float = 1.0
    """Further factor of the distance, but not of the turning, 0…1."""

    rate: float = 1.0
    """Factor of the speed of the clips."""

    @cached_property
    def duration(self) -> float:
        """Length of one cycle [s]."""
        motions = self.trajectories.motions
        return 1.0 / (sum(w / motions[n].duration for n, w in self.contributions) * self.rate)

    def at(self, phase: float) -> Pose:
        """Return the mixed pose at a phase."""
        pose, feet = self.trajectories.mix(self.contributions, phase, self.share)
        if len(self.contributions) == 1 and self.share == self.stride == 1.0:
            return pose
        return self.trajectories.legs.reach(pose, *self._feet(feet))

    def contacts(self, phase: float) -> list[float]:
        """Return the weighted mean of the contacts of each foot, 0…1."""
        return self.trajectories.contacts(self.contributions, phase)

    def between(self, start: float, end: float) -> RootDelta:
        """Return how the root moves over the ground between two phases."""
        total = RootDelta()
        parts = max(math.ceil((end - start) * _PARTS_PER_CYCLE), 1)
        each, distance = (end - start) / parts, self.share * self.stride
        for part in range(parts):
            low = start + each * part
            x = z = yaw = 0.0
            for number, weight in self.contributions:
                delta = self.trajectories.travel(number, low, low + each)
                x, z, yaw = x + weight * delta.x, z + weight * delta.z, yaw + weight * delta.yaw
            delta = RootDelta(x * distance, z * distance, yaw * self.share)
            total = total.then(delta) if part else delta
        return total

    def _feet(self, feet: Sequence[Sequence[float]]) -> tuple[list[Vector], list[Quaternion]]:
        """Return positions of the balls and orientations of the feet.

        `feet` are ball, orientation and contact of each foot, the mean of the clips.
        """
        balls: list[Vector] = []
        facings: list[Quaternion] = []
        for leg, (foot, still) in enumerate(zip(feet, self.trajectories.stance, strict=True)):
            x, y, z, *facing = foot[:7]
            if self.share == self.stride == 1.0:
                balls.append((x, y, z))
                facings.append(normalize(facing))
                continue
            home = [0.0] * len(still)
            for number, weight in self.contributions:
                own = self.trajectories.homes[number][leg]
                home = [value + weight * more for value, more in zip(home, own, strict=True)]
            if self.share < 1.0:
                higher = (y - home[1]) * self.share**_HEIGHT_EXPONENT
                x, _, z, *facing = _interpolate(still, foot, self.share)
                home = _interpolate(still, home, self.share)
                y = home[1] + higher
            faced = normalize(facing)
            if self.stride < 1.0:
                y += (y - home[1]) * _TURNING_EXTRA_HEIGHT * (1.0 - self.stride)
                x, z = self._shorten_stride(x, z, home, _yaw_between(faced, normalize(home[3:])))
            balls.append((x, y, z))
            facings.append(faced)
        return balls, facings

    def _shorten_stride(
        self, x: float, z: float, home: Sequence[float], yaw: float
    ) -> tuple[float, float]:
        """Return x, z of a foot, moved towards its position under a body that only turns.

        That position is `home` rotated about the root by the foot's own `yaw` [rad].
        """
        sine, cosine, drawn = math.sin(yaw), math.cos(yaw), 1.0 - self.stride
        return (
            x + drawn * (cosine * home[0] + sine * home[2] - x),
            z + drawn * (cosine * home[2] - sine * home[0] - z),
        )


def _interpolate(still: Sequence[float], foot: Sequence[float], share: float) -> list[float]:
    """Return values of a foot between those of the stance and those of the clips."""
    return [a + share * (b - a) for a, b in zip(still, foot, strict=False)]


def _yaw_between(facing: Quaternion, reference: Quaternion) -> float:
    """Return the rotation about +y from one orientation to another [rad]."""
    _, y, _, w = multiply(facing, conjugate(reference))
    return math.remainder(2 * math.atan2(y, w), math.tau)
