"""The stroke of a gesture as a motion: key postures of the upper body, and frames between them."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from characters.motion.motion import RootDelta
from characters.skeleton import rotations
from characters.skeleton.pose import Array, Pose


@dataclass(frozen=True, eq=False)
class GestureMotion:
    """Key postures at times; between them, joints turn along the shortest arc.

    Arms and hands are absolute: they replace those below. Trunk and head are turns that are added
    to what the body does.
    """

    rest: Pose
    """The posture from which it was planned."""

    times: Array
    """Of the key postures, (keys,), 0…1."""

    arms: NDArray[np.intp]
    """Joints of arms and hands, (a,)."""

    arm_turns: Array
    """Their local rotations, (keys, a, 4), without jumps of sign."""

    trunk: NDArray[np.intp]
    """Joints of trunk and head, (t,)."""

    trunk_turns: Array
    """What is added to their local rotations, (keys, t, 4), without jumps of sign."""

    duration: float = 1.0
    """Time from the first posture to the last [s]."""

    def turns(self, share: float) -> tuple[Array, Array]:
        """Return the rotations of arms (a, 4) and trunk (t, 4) at a time, 0…1 of the stroke."""
        after = int(np.searchsorted(self.times, share, "right"))
        if after == 0 or after == len(self.times):
            key = min(after, len(self.times) - 1)
            return self.arm_turns[key], self.trunk_turns[key]
        low, high = float(self.times[after - 1]), float(self.times[after])
        u = (share - low) / (high - low)
        return (
            rotations.slerp(self.arm_turns[after - 1], self.arm_turns[after], u),
            rotations.slerp(self.trunk_turns[after - 1], self.trunk_turns[after], u),
        )

    def over(self, pose: Pose, share: float, weight: float) -> Pose:
        """Return a pose with the gesture at a time of its stroke laid over it by a weight.

        Weights are 0…1; a little more overshoots.
        """
        if weight <= 0.0:
            return pose
        arms, trunk = self.turns(share)
        turned = pose.rotations.copy()
        if weight != 1.0:
            arms = rotations.slerp(turned[self.arms], arms, weight)
            trunk = rotations.slerp(IDENTITY, trunk, weight)
        turned[self.arms] = arms
        turned[self.trunk] = rotations.multiply(turned[self.trunk], trunk)
        return Pose(pose.translations, turned, pose.scales, pose.morphs)

    def sample(self, time: float) -> Pose:
        """Return the posture at a time of the stroke [s]."""
        return self.over(self.rest, time / max(self.duration, 1e-9), 1.0)

    def travel(self, start: float, end: float) -> RootDelta:
        """Return no movement over the ground."""
        return RootDelta()


IDENTITY = np.array([0.0, 0.0, 0.0, 1.0])
"""The rotation by nothing."""
