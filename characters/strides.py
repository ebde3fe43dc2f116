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

import numpy as np

from characters import rotations
from characters.motion import STANDING, Step
from characters.pose import Array, Pose
from characters.treads import Treads

_PARTS = 16  # of a cycle, in each of which the mean of several ways is taken
_LIFT = 0.3  # how high feet go rises with this power of how far they go, …
_TURNING = 1.0  # … and on the spot by so much more than that, to clear the ground


@dataclass(frozen=True)
class Strides:
    """Clips mixed in step, with shorter steps and at another pace; `Cyclic`."""

    treads: Treads
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
        motions = self.treads.motions
        return 1.0 / (sum(w / motions[n].duration for n, w in self.voices) * self.rate)

    def at(self, phase: float) -> Pose:
        """Return the mixed pose at a phase."""
        pose, feet = self.treads.mixed(self.voices, phase, self.share)
        if len(self.voices) == 1 and self.share == self.stride == 1.0:
            return pose
        balls, facings = self._feet(feet)
        return self.treads.legs.reach(pose, balls.tolist(), facings.tolist())

    def contacts(self, phase: float) -> list[float]:
        """Return how much of the mix has each foot on the ground, 0…1."""
        return self.treads.contacts(self.voices, phase)

    def between(self, start: float, end: float) -> Step:
        """Return how the root moves over the ground between two phases."""
        total = STANDING
        parts = max(math.ceil((end - start) * _PARTS), 1)
        each = (end - start) / parts
        for low in (start + each * part for part in range(parts)):
            x = z = yaw = 0.0
            for number, weight in self.voices:
                step = self.treads.travel(number, low, low + each)
                x, z, yaw = x + weight * step.x, z + weight * step.z, yaw + weight * step.yaw
            way = self.share * self.stride
            total = total.then(Step(x * way, z * way, yaw * self.share))
        return total

    def sample(self, time: float) -> Pose:
        """Return the mixed pose at a time [s] since phase 0."""
        return self.at(time / self.duration)

    def travel(self, start: float, end: float) -> Step:
        """Return how the root moves over the ground between two times [s]."""
        duration = self.duration
        return self.between(start / duration, end / duration)

    def _feet(self, feet: Array) -> tuple[Array, Array]:
        """Return where the balls of the feet are to be, (legs, 3), and how they face, (legs, 4).

        `feet` (legs, 8) are the mean of the clips' feet.
        """
        still, feet = self.treads.stance.feet, feet[:, :7]
        home = sum(weight * self.treads.homes[number] for number, weight in self.voices)
        if self.share < 1.0:
            drawn = still + self.share * (feet - still)
            middle = still + self.share * (home - still)
            drawn[:, 1] = middle[:, 1] + (feet[:, 1] - home[:, 1]) * self.share**_LIFT
            feet, home = drawn, middle
        facing = rotations.normalize(feet[:, 3:])
        if self.stride < 1.0:
            feet[:, 1] += (feet[:, 1] - home[:, 1]) * _TURNING * (1.0 - self.stride)
            self._draw(feet, home, _twist(facing, rotations.normalize(home[:, 3:])))
        return feet[:, :3], facing

    def _draw(self, feet: Array, home: Array, yaw: Array) -> None:
        """Draw feet (legs, 7) to where they would be if the body only turned.

        Such a foot goes round the root as far as it turns itself: `yaw` (legs,) [rad].
        """
        sine, cosine = np.sin(yaw), np.cos(yaw)
        x, z = home[:, 0], home[:, 2]
        less = 1.0 - self.stride
        feet[:, 0] += less * (cosine * x + sine * z - feet[:, 0])
        feet[:, 2] += less * (cosine * z - sine * x - feet[:, 2])


def _twist(turn: Array, reference: Array) -> Array:
    """Return how far rotations (n, 4) are turned about +y from others [rad], (n,)."""
    _, y, _, w = rotations.multiply(turn, rotations.conjugate(reference)).T
    angle: Array = 2 * np.arctan2(y, w)
    return np.asarray(np.remainder(angle + np.pi, 2 * np.pi) - np.pi)
