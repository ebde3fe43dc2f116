"""Gaits: walking and running at any speed and turn, by AvatAR's movement tree.

Source: Fernández-Baena's thesis, section 5.2. Both trees, over Angular, are blended over Speed.
"""

import math
from collections.abc import Mapping
from functools import cached_property

import numpy as np

from cubeling.characters.ik.legs import find_legs
from cubeling.characters.locomotion.foot_trajectories import FootTrajectories
from cubeling.characters.locomotion.stride_blending import StrideBlend
from cubeling.characters.motion.blend import Blend, BlendSpace1D, TimeScaled
from cubeling.characters.motion.clip import Clip
from cubeling.characters.motion.contacts import find_contacts
from cubeling.characters.motion.motion import Motion
from cubeling.characters.motion.phase import PhasedMotion, StaticPose, with_phase
from cubeling.characters.skeleton.pose import Pose, Skeleton
from cubeling.characters.smoothing import interpolate

IDLE_SPEED = 0.5
"""Largest Speed at which a character stands."""

RUN_SPEED = 3.0
"""Speed above which it runs."""

TOP_SPEED = 5.0
"""Largest Speed of AvatAR."""

MAX_ANGULAR_RAD = math.pi / 2
"""Largest value of AvatAR's parameter Angular [rad]."""

MIN_CYCLE_LENGTH = 0.1
"""A cycle that goes less far is no gait [heights of the character]."""

WALK_CLIPS = {
    -90.0: "WalkLeftShort",
    -60.0: "WalkLeftMedium",
    -30.0: "WalkLeftWide",
    0.0: "Walk",
    30.0: "WalkRightWide",
    60.0: "WalkRightMedium",
    90.0: "WalkRightShort",
}
"""The walk tree: clips by Angular [degrees]. "Short" is the tightest curve."""

RUN_CLIPS = {
    -90.0: "RunLeftMedium",
    -45.0: "RunLeftWide",
    0.0: "Run",
    45.0: "RunRightWide",
    90.0: "RunRightMedium",
}
"""The run tree: clips by Angular [degrees]."""

WALK_RUN_SPEEDS = (2.75, 3.25)
"""Speeds between which walking and running are mixed."""

GAIT_CHANGE_S = 0.17
"""How long it takes at least from walking to running, and back [s]: sooner, the knee of a foot that
stands in the one and swings in the other is thrown there (`python -m tests.bench.takeovers`)."""

# Ground speeds as multiples of the recorded walk or run: slowest and fastest of each.
_SLOW_WALK, _FAST_WALK, _SLOW_RUN, _FAST_RUN = 0.5, 1.3, 0.8, 1.25
# Slow walking has shorter and slower steps (Grieve and Gear, "The relationships between length of
# stride …", 1966); this power of the slowdown is the factor of the step length.
_STEP_LENGTH_EXPONENT = 0.5
_RADIUS_PART = 1 / 16  # of a cycle
_IN_PLACE_SHORTENING = 0.4  # steps in place are shorter by this part


class Gaits:
    """The movement tree of a character: a motion for every Speed and Angular.

    The clips are "Walk" and, if available, the others of `WALK_CLIPS` and `RUN_CLIPS`. Slow walking
    is mixed with the `standing` pose, which shortens its steps.
    """

    def __init__(self, clips: Mapping[str, Clip], skeleton: Skeleton, standing: Pose) -> None:
        walks = _phased_clips(clips, WALK_CLIPS, skeleton)
        runs = _phased_clips(clips, RUN_CLIPS, skeleton) if "Run" in clips else {}
        self._walk = BlendSpace1D(tuple(walks), tuple(walks.values()))
        self._run = BlendSpace1D(tuple(runs), tuple(runs.values())) if runs else self._walk
        self.legs = find_legs(skeleton)
        """The legs that keep feet from sliding, or None if the skeleton has no suitable legs."""
        self._skeleton = skeleton
        self._contacts: dict[int, tuple[Clip, list[list[bool]]]] = {}
        self._radii: dict[float, float] = {}
        self._still = StaticPose(standing, self._walk.at(0.0).duration)
        self._trajectories: FootTrajectories | None = None
        if self.legs is not None:
            motions = [*walks.values(), *runs.values()]
            self._trajectories = FootTrajectories.of(motions, skeleton, self.legs, standing)
            self._numbers = {id(motion): number for number, motion in enumerate(motions)}
        straight = [tree.at(0.0) for tree in (self._walk, self._run)]
        self._lengths = [motion.between(0.0, 1.0).length for motion in straight]
        self._cadences = [1.0 / motion.duration for motion in straight]
        walk, run = (x * y for x, y in zip(self._lengths, self._cadences, strict=True))
        self._speeds = [IDLE_SPEED, *WALK_RUN_SPEEDS, TOP_SPEED]
        paces = [_SLOW_WALK * walk, _FAST_WALK * walk, _SLOW_RUN * run, _FAST_RUN * run]
        self._paces = [max(paces[: count + 1]) for count in range(len(paces))]

    def contacts(self, clip: Clip) -> list[list[bool]]:
        """Return which feet of the legs are on the ground in each frame of a clip.

        They are found when a clip is first asked for, which takes some milliseconds.
        """
        if id(clip) not in self._contacts:
            feet = () if self.legs is None else self.legs.feet
            found: list[list[bool]] = find_contacts(clip, self._skeleton, feet).tolist()
            self._contacts[id(clip)] = clip, found  # the clip is kept, so that its number stays its
        return self._contacts[id(clip)][1]

    def pace(self, speed: float) -> float:
        """Return the ground speed straight ahead at a Speed [m/s]; monotonic."""
        return interpolate(speed, self._speeds, self._paces)

    def speed(self, pace: float) -> float:
        """Return the Speed for a ground speed [m/s]: the inverse of `pace`."""
        return interpolate(pace, self._paces, self._speeds)

    @staticmethod
    def next_speed(used: float, wanted: float, elapsed: float) -> float:
        """Return the Speed a time [s] after `used` on the way to another one.

        It is what is wanted, unless that is too soon for a change between walking and running.
        """
        low, high = WALK_RUN_SPEEDS
        most = elapsed * (high - low) / GAIT_CHANGE_S
        if used < wanted and wanted > low and used < high:
            return min(wanted, max(used, low) + most)
        if used > wanted and used > low and wanted < high:
            return max(wanted, min(used, high) - most)
        return wanted

    @cached_property
    def first_phase(self) -> float:
        """Phase of the slowest walk that is most similar to the standing pose: where to set off."""
        motion, phases = self.at(IDLE_SPEED, 0.0), np.arange(32) / 32
        standing, *walking = (
            pose.globals(self._skeleton)[:, :3, 3]
            for pose in (self._still.pose, *map(motion.at, phases))
        )
        errors = [np.square(places - standing).sum() for places in walking]
        return float(phases[int(np.argmin(errors))])

    def radius(self, speed: float) -> float:
        """Return the radius of the tightest curve at a Speed [m], which is measured once."""
        if speed not in self._radii:
            self._radii[speed] = self._measure_radius(speed)
        return self._radii[speed]

    def _measure_radius(self, speed: float) -> float:
        motion = self.at(speed, MAX_ANGULAR_RAD)
        # In parts, because an animal may walk a whole circle in one slow cycle.
        parts = [motion.between(at, at + _RADIUS_PART) for at in np.arange(0.0, 1.0, _RADIUS_PART)]
        turn = abs(sum(part.yaw for part in parts))
        return sum(math.hypot(part.x, part.z) for part in parts) / max(turn, 1e-6)

    def at(self, speed: float, angular: float, stride: float = 1.0) -> "StrideBlend | TimeScaled":
        """Return the motion at a Speed, of which at least 0.5 is used, and an Angular.

        Angular is the turning rate [rad], −π/2…π/2, positive to the right; `stride` is a factor of
        the distance over the ground, for tighter turns than any clip.
        """
        running = interpolate(speed, WALK_RUN_SPEEDS, (0.0, 1.0))
        rate, share = self._rate_and_step_length(speed, running)
        shortening = 1.0 - _IN_PLACE_SHORTENING * (1.0 - stride)
        share *= shortening
        rate /= math.sqrt(shortening)
        active = self._active(running, math.degrees(angular))
        if self._trajectories is not None:
            numbered = [(self._numbers[id(motion)], weight) for motion, weight in active]
            return StrideBlend(self._trajectories, numbered, share, stride, rate)
        motions, weights = zip(*active, strict=True)
        mixed = Blend(motions, weights)
        if share < 1.0:
            mixed = Blend((mixed, self._still), (share, 1.0 - share))
        return TimeScaled(mixed, rate, stride)

    def _rate_and_step_length(self, speed: float, running: float) -> tuple[float, float]:
        """Return the factors of clip speed and step length that give the ground speed."""
        length = self._lengths[0] * (1.0 - running) + self._lengths[1] * running
        cadence = self._cadences[0] * (1.0 - running) + self._cadences[1] * running
        rate = self.pace(speed) / (length * cadence)
        share = rate**_STEP_LENGTH_EXPONENT if rate < 1.0 and running == 0.0 else 1.0
        return rate / share, share

    def _active(self, running: float, degrees: float) -> list[tuple[Motion, float]]:
        """Return the clips of positive weight and their weights."""
        active: list[tuple[Motion, float]] = []
        for tree, part in ((self._walk, 1.0 - running), (self._run, running)):
            weights = tree.weights(degrees) if part > 0.0 else ()
            active += [
                (motion, part * weight)
                for motion, weight in zip(tree.motions, weights, strict=False)
                if weight > 0.0
            ]
        return active


def _phased_clips(
    clips: Mapping[str, Clip], names: Mapping[float, str], skeleton: Skeleton
) -> dict[float, PhasedMotion]:
    return {
        knot: with_phase(clips[name], skeleton) for knot, name in names.items() if name in clips
    }
