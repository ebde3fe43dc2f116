"""Walking and running, as fast and as tight as asked: AvatAR's movement tree.

Source: Fernández-Baena's thesis, section 5.2: a walk tree of seven clips and a run tree of five,
each over Angular, −90…90°, joined over Speed, where 3 is the border between walking and running.
"""

import math
from collections.abc import Mapping

from characters.ik.legs import find_legs
from characters.locomotion.foot_trajectories import FootTrajectories
from characters.locomotion.stride_blending import StrideBlend
from characters.motion.blend import Blend, BlendSpace1D, TimeScaled
from characters.motion.clip import Clip
from characters.motion.phase import PhasedMotion, StaticPose, phased
from characters.skeleton.pose import Pose, Skeleton
from characters.smoothing import interpolate

IDLE_SPEED = 0.5
"""AvatAR's Speed up to which a character stands."""

RUN_SPEED = 3.0
"""AvatAR's Speed above which it runs."""

TOP_SPEED = 5.0
"""AvatAR's greatest Speed."""

MAX_ANGULAR_RAD = math.pi / 2
"""The greatest Angular [rad]."""

WALK_CLIPS = {
    -90.0: "WalkLeftShort",
    -60.0: "WalkLeftMedium",
    -30.0: "WalkLeftWide",
    0.0: "Walk",
    30.0: "WalkRightWide",
    60.0: "WalkRightMedium",
    90.0: "WalkRightShort",
}
"""The walk tree: clips by Angular [degrees]; the shortest curve is the tightest."""

RUN_CLIPS = {
    -90.0: "RunLeftMedium",
    -45.0: "RunLeftWide",
    0.0: "Run",
    45.0: "RunRightWide",
    90.0: "RunRightMedium",
}
"""The run tree."""

WALK_RUN_SPEEDS = (2.75, 3.25)
"""Speeds between which walking is mixed into running."""

# Speeds, and how fast the ground goes by there as a multiple of the walk or the run as recorded.
_STROLL, _BRISK, _JOG, _SPRINT = 0.5, 1.3, 0.8, 1.25
# Of the slowdown to a stroll, this power goes into shorter steps and the rest into slower ones:
# people do both (Grieve and Gear, "The relationships between length of stride …", 1966).
_SHORTENING = 0.5
_SMALLER = 0.4  # how much smaller steps on the spot are than steps on the way


class Gaits:
    """The movement tree of a character: a motion for every Speed and Angular.

    Parameters
    ----------
    clips
        "Walk" and, as far as there are any, the others of `WALK_CLIPS` and `RUN_CLIPS`.
    skeleton
        Whose feet mark the phases.
    standing
        The pose that slow walking leans to, so that its steps become shorter.
    """

    def __init__(self, clips: Mapping[str, Clip], skeleton: Skeleton, standing: Pose) -> None:
        self._walk = _tree(clips, WALK_CLIPS, skeleton)
        self._run = _tree(clips, RUN_CLIPS, skeleton) if "Run" in clips else self._walk
        self.legs = find_legs(skeleton)
        """The legs that keep to the ground, or None where there are none to bend."""
        self._still = StaticPose(standing, self._walk.at(0.0).duration)
        self._trajectories: FootTrajectories | None = None
        if self.legs is not None:
            motions = [*self._walk.motions, *(() if self._run is self._walk else self._run.motions)]
            both = [motion for motion in motions if isinstance(motion, PhasedMotion)]
            self._trajectories = FootTrajectories.of(both, skeleton, self.legs, standing)
            self._numbers = {id(motion): number for number, motion in enumerate(both)}
        straight = [tree.at(0.0) for tree in (self._walk, self._run)]
        self._lengths = [motion.between(0.0, 1.0).length for motion in straight]
        self._cadences = [1.0 / motion.duration for motion in straight]
        walk, run = (x * y for x, y in zip(self._lengths, self._cadences, strict=True))
        self._speeds = [IDLE_SPEED, *WALK_RUN_SPEEDS, TOP_SPEED]
        paces = [_STROLL * walk, _BRISK * walk, _JOG * run, _SPRINT * run]
        self._paces = [max(paces[: count + 1]) for count in range(len(paces))]

    def pace(self, speed: float) -> float:
        """Return how fast the ground goes by at a Speed, going straight [m/s]; rises with it."""
        return interpolate(speed, self._speeds, self._paces)

    def speed(self, pace: float) -> float:
        """Return the Speed at which the ground goes by so fast [m/s]: the inverse of `pace`."""
        return interpolate(pace, self._paces, self._speeds)

    def radius(self, speed: float) -> float:
        """Return the radius of the tightest curve at a Speed [m]."""
        cycle = self.at(speed, MAX_ANGULAR_RAD).between(0.0, 1.0)
        return math.hypot(cycle.x, cycle.z) / max(2 * math.sin(abs(cycle.yaw) / 2), 1e-6)

    def at(self, speed: float, angular: float, stride: float = 1.0) -> "StrideBlend | TimeScaled":
        """Return the motion at a Speed and an Angular.

        Parameters
        ----------
        speed
            AvatAR's Speed; below 0.5 it is taken as 0.5.
        angular
            How sharply to turn [rad], −π/2…π/2; positive to the right.
        stride
            What the way over the ground is multiplied with, to turn tighter than any clip.
        """
        running = interpolate(speed, WALK_RUN_SPEEDS, (0.0, 1.0))
        # Steps on the spot are small ones.
        smaller = 1.0 - _SMALLER * (1.0 - stride)
        rate, share = self._effort(speed, running)
        share *= smaller
        rate /= math.sqrt(smaller)
        heard = self._heard(running, math.degrees(angular))
        if self._trajectories is not None:
            voices = [(self._numbers[id(motion)], weight) for motion, weight in heard]
            return StrideBlend(self._trajectories, voices, share, stride, rate)
        mixed = Blend(tuple(motion for motion, _ in heard), tuple(weight for _, weight in heard))
        if share < 1.0:
            mixed = Blend((mixed, self._still), (share, 1.0 - share))
        return TimeScaled(mixed, rate, stride)

    def _effort(self, speed: float, running: float) -> tuple[float, float]:
        """Return how fast the clips play and how far their steps reach, for the right pace."""
        length = self._lengths[0] * (1.0 - running) + self._lengths[1] * running
        cadence = self._cadences[0] * (1.0 - running) + self._cadences[1] * running
        rate = self.pace(speed) / (length * cadence)
        share = rate**_SHORTENING if rate < 1.0 and running == 0.0 else 1.0
        return rate / share, share

    def _heard(self, running: float, degrees: float) -> list[tuple[PhasedMotion, float]]:
        """Return the clips that sound and how much of each."""
        heard: list[tuple[PhasedMotion, float]] = []
        for tree, part in ((self._walk, 1.0 - running), (self._run, running)):
            weights = tree.weights(degrees) if part > 0.0 else ()
            heard += [
                (motion, part * weight)
                for motion, weight in zip(tree.motions, weights, strict=False)
                if weight > 0.0 and isinstance(motion, PhasedMotion)
            ]
        return heard


def _tree(
    clips: Mapping[str, Clip], names: Mapping[float, str], skeleton: Skeleton
) -> BlendSpace1D:
    """Return the tree of the clips that there are."""
    there = {knot: name for knot, name in names.items() if name in clips}
    return BlendSpace1D(
        tuple(there), tuple(phased(clips[name], skeleton) for name in there.values())
    )
