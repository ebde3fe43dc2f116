"""The stroke of a gesture as a motion: key postures of the upper body, and frames between them."""

from bisect import bisect_right
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from cubeling.characters.behaviour.gestures.timing import Repeats
from cubeling.characters.motion.layers import lay_over
from cubeling.characters.motion.motion import RootDelta
from cubeling.characters.skeleton import rotations
from cubeling.characters.skeleton.pose import Array, Pose


@dataclass(frozen=True, eq=False)
class GestureMotion:
    """Key postures at times of one stroke; between them joints turn along the shortest arc.

    Arms and hands are absolute: they replace those below. Trunk and head are turns that are added
    to what the body does. Key postures are so dense that a normalised linear interpolation is a
    slerp to within a tenth of a degree, at a quarter of its time.
    """

    rest: Pose
    """The posture from which it was planned."""

    times: Array
    """Of the key postures, (keys,), from 0…1 on, of one stroke and its way back."""

    arms: NDArray[np.intp]
    """Joints of arms and hands, (a,)."""

    arm_turns: Array
    """Their local rotations, (keys, a, 4), without jumps of sign."""

    trunk: NDArray[np.intp]
    """Joints of trunk and head, (t,)."""

    trunk_turns: Array
    """What is added to their local rotations, (keys, t, 4), without jumps of sign."""

    repeats: Repeats = Repeats(1, 1.0)  # noqa: RUF009 - frozen
    """How often the stroke is performed."""

    duration: float = 1.0
    """Time from the first posture to the last [s]."""

    def turns(self, share: float) -> Array:
        """Return the rotations of arms and trunk at a time 0…1 of all strokes, (a + t, 4).

        They are not normalised.
        """
        time = self.repeats.period_share(share)
        times = self._times
        after = bisect_right(times, time)
        if after in (0, len(times)):
            key: Array = self._turns[min(after, len(times) - 1)].copy()
            return key
        low = times[after - 1]
        mixed: Array = self._steps[after - 1] * ((time - low) / (times[after] - low))
        mixed += self._turns[after - 1]
        return mixed

    def over(self, pose: Pose, share: float, weight: float) -> Pose:
        """Return a pose with the gesture at a time of its strokes laid over it by a weight.

        Weights are 0…1; a little more overshoots.
        """
        if weight <= 0.0:
            return pose
        moved, arms = self._moved, len(self.arms)
        turns = self.turns(share)
        if arms < len(moved):
            turns[arms:] = rotations.multiply(pose.rotations.take(self.trunk, 0), turns[arms:])
        return lay_over(pose, moved, turns, weight)

    def sample(self, time: float) -> Pose:
        """Return the posture at a time of the strokes [s]."""
        return self.over(self.rest, min(max(time / max(self.duration, 1e-9), 0.0), 1.0), 1.0)

    def travel(self, start: float, end: float) -> RootDelta:
        """Return no movement over the ground."""
        return RootDelta()

    @cached_property
    def _times(self) -> list[float]:
        times: list[float] = self.times.tolist()
        return times

    @cached_property
    def _turns(self) -> Array:
        trunk = rotations.align(self.trunk_turns, (0.0, 0.0, 0.0, 1.0))
        return np.concatenate([self.arm_turns, trunk], axis=1)

    @cached_property
    def _steps(self) -> Array:
        return np.diff(self._turns, axis=0)

    @cached_property
    def _moved(self) -> NDArray[np.intp]:
        return np.concatenate([self.arms, self.trunk])
