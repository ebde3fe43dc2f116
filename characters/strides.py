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
from functools import cached_property

import numpy as np

from characters import rotations
from characters.blend import mix
from characters.clip import Clip
from characters.contacts import find_contacts
from characters.legs import Legs
from characters.motion import STANDING, Step
from characters.phase import Phased
from characters.pose import Array, Pose, Skeleton

_PARTS = 16  # of a cycle, in each of which the mean of several ways is taken
_LEAVING = 0.45  # how much the last frame of a contact counts: too little to be held
_LIFT = 0.3  # how high feet go rises with this power of how far they go, …
_TURNING = 1.0  # … and on the spot by so much more than that, to clear the ground


@dataclass(frozen=True)
class Tread:
    """A looped clip and where its feet are, frame by frame."""

    motion: Phased
    """The clip by its phase."""

    feet: Array
    """Ball of the foot (3), facing of the foot (4), whether it stands (1): (frames, legs, 8)."""

    @staticmethod
    def of(motion: Phased, skeleton: Skeleton, legs: Legs, still: "Stance") -> "Tread":
        """Return the tread of a clip, with contacts that are found in it.

        Its feet face on the side of quaternions on which those of a stance do.
        """
        clip = motion.motion
        assert isinstance(clip, Clip)
        feet = np.concatenate([_feet(clip.in_place, legs), np.zeros((len(clip), legs.count, 1))], 2)
        feet[..., 3:7] = rotations.align(feet[..., 3:7], still.feet[:, 3:])
        down = find_contacts(clip, skeleton, legs.feet)
        # A foot is known to have left by its speed, so a little after it has.
        after = np.roll(down[:-1], -1, axis=0)
        leaving = down & ~np.append(after, after[:1], axis=0)
        feet[..., 7] = np.where(leaving, _LEAVING, down)
        return Tread(motion, feet)

    def at(self, phase: float) -> Array:
        """Return where its feet are at a phase, (legs, 8)."""
        last = len(self.feet) - 1
        at = self.motion.time(phase) / self.motion.motion.duration % 1.0 * last
        frame = min(int(at), last - 1)
        here = self.feet[frame]
        between: Array = here + (self.feet[frame + 1] - here) * (at - frame)
        return between

    @cached_property
    def home(self) -> Array:
        """The middle of where a foot stands, on the ground, and how it faces there, (legs, 8)."""
        weight = self.feet[..., 7:] + 1e-6
        mean: Array = (self.feet * weight).sum(0) / weight.sum(0)
        mean[:, 1] = self.feet[..., 1].min(0)
        mean[:, 3:7] = rotations.normalize(mean[:, 3:7])
        return mean


@dataclass(frozen=True)
class Stance:
    """A pose that is stood in, and where its feet are."""

    pose: Pose
    """The pose."""

    feet: Array
    """Ball (3) and facing (4) of each foot, (legs, 7)."""

    @staticmethod
    def of(pose: Pose, legs: Legs) -> "Stance":
        """Return the stance of a pose."""
        return Stance(pose, _feet(pose, legs))


@dataclass(frozen=True)
class Strides:
    """Clips mixed in step, with shorter steps and at another pace; `Cyclic`."""

    treads: tuple[Tread, ...]
    """What is mixed."""

    weights: tuple[float, ...]
    """How much of each; positive, sum one."""

    legs: Legs
    """Whose feet they are."""

    still: Stance
    """What shorter steps lean to."""

    share: float = 1.0
    """How long steps are and how far they turn, as a part of the clips'; the rest is `still`."""

    stride: float = 1.0
    """What is left of the way, but not of the turning, after that."""

    rate: float = 1.0
    """How much faster than the clips."""

    @property
    def duration(self) -> float:
        """Length of one cycle [s]."""
        paces = [
            weight / tread.motion.duration
            for tread, weight in zip(self.treads, self.weights, strict=True)
        ]
        return 1.0 / (sum(paces) * self.rate)

    def at(self, phase: float) -> Pose:
        """Return the mixed pose at a phase."""
        poses = [tread.motion.at(phase) for tread in self.treads]
        weights = list(self.weights)
        if self.share < 1.0:
            poses.append(self.still.pose)
            weights = [*(weight * self.share for weight in weights), 1.0 - self.share]
        elif len(poses) == 1 and self.stride == 1.0:
            return poses[0]
        balls, facings = self._feet(phase)
        return self.legs.reach(mix(poses, weights), balls, facings)

    def contacts(self, phase: float) -> Array:
        """Return how much of the mix has each foot on the ground, (legs,), 0…1."""
        each = [tread.at(phase)[:, 7] for tread in self.treads]
        return np.asarray(self.weights) @ np.stack(each)

    def between(self, start: float, end: float) -> Step:
        """Return how the root moves over the ground between two phases."""
        total = STANDING
        parts = max(math.ceil((end - start) * _PARTS), 1)
        each = (end - start) / parts
        for low in (start + each * part for part in range(parts)):
            x = z = yaw = 0.0
            for tread, weight in zip(self.treads, self.weights, strict=True):
                step = tread.motion.between(low, low + each)
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

    def _feet(self, phase: float) -> tuple[Array, Array]:
        """Return where the balls of the feet are to be, (legs, 3), and how they face, (legs, 4)."""
        still = self.still.feet
        feet = self._mean([tread.at(phase) for tread in self.treads])
        home = self._mean([tread.home for tread in self.treads])
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

    def _mean(self, feet: Sequence[Array]) -> Array:
        """Return the mean of feet, (legs, 7); facings lie on the same side as the stance's."""
        total: Array = feet[0][:, :7] * self.weights[0]
        for each, weight in zip(feet[1:], self.weights[1:], strict=True):
            total = total + each[:, :7] * weight
        return total


def _feet(poses: Pose, legs: Legs) -> Array:
    """Return the ball and the facing of each foot in poses (…), (…, legs, 7)."""
    placed = legs.globals(poses)
    ankle, toes = legs.joints[:, 3], legs.joints[:, 4]
    facing = rotations.from_matrix(placed[..., :3, :3][..., ankle, :, :])
    return np.concatenate([placed[..., :3, 3][..., toes, :], facing], axis=-1)


def _twist(turn: Array, reference: Array) -> Array:
    """Return how far rotations (n, 4) are turned about +y from others [rad], (n,)."""
    _, y, _, w = rotations.multiply(turn, rotations.conjugate(reference)).T
    angle: Array = 2 * np.arctan2(y, w)
    return np.asarray(np.remainder(angle + np.pi, 2 * np.pi) - np.pi)
