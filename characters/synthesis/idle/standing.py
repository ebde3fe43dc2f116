"""A person who stands: her idle motion, and now and then an act.

Source: Egges, Molet and Magnenat-Thalmann 2004, section 4: besides balance shifts and small
variations there are acts, such as to touch one's hair, which are played as they were recorded.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from affect import NEUTRAL, Emotion
from affect.regions import region_of
from characters.ik.legs import LegFrames, LegIK, find_paws
from characters.motion.clip import Clip
from characters.motion.motion import RootDelta
from characters.motion.state_machine import StateMachine
from characters.skeleton.anatomy import Anatomy
from characters.skeleton.pose import Pose, Skeleton
from characters.skeleton.scalar_quaternions import conjugate, multiply
from characters.synthesis.idle.idle_motion import IdleMotion

PAUSE_S = 10.0, 24.0
"""Shortest and longest time between acts [s]."""

TRANSITION_S = 0.7
"""How long it goes over into an act and back [s]."""


@dataclass(frozen=True)
class PlantedPaws:
    """Where the paws of a quadruped stand."""

    legs: LegIK

    frames: LegFrames
    """Of the pose in which it stands so."""

    @staticmethod
    def of(pose: Pose, skeleton: Skeleton, anatomy: Anatomy) -> "PlantedPaws | None":
        """Return the paws of a standing quadruped; None for other bodies."""
        legs = find_paws(skeleton, anatomy)
        return None if legs is None else PlantedPaws(legs, legs.frames(pose))

    def hold(self, pose: Pose) -> Pose:
        """Return a pose with its paws where they stand."""
        now, paws = self.legs.frames(pose), self.legs.joints[:, 3].tolist()
        places = [self.frames.positions[paw] for paw in paws]
        turns = [multiply(self.frames.rotations[n], conjugate(now.rotations[n])) for n in paws]
        return self.legs.bend(pose, now, places, turns)


class StandingPerson:
    """Idle motion with acts; a `StandingMotion`, to be sampled in the order of time.

    Acts are played while the emotion is neutral. One who begins to feel breaks them off. Paws may
    be planted here; feet are by a layer of the animator.
    """

    def __init__(
        self,
        idle: IdleMotion,
        acts: Sequence[Clip],
        seed: int = 0,
        paws: PlantedPaws | None = None,
    ) -> None:
        self._paws = paws
        self._idle, self._acts = idle, {clip.name: clip for clip in acts}
        self._machine = StateMachine({"": idle, **self._acts}, "", TRANSITION_S)
        self._rng = np.random.default_rng([seed, 1])
        self._neutral = True
        self._clock = self._last = 0.0  # played, and asked for last [s]
        self._change = self._rng.uniform(*PAUSE_S)  # when the present state ends [s]

    @property
    def duration(self) -> float:
        """Infinite."""
        return math.inf

    def feel(self, emotion: Emotion | None) -> None:
        """Show an emotion from now on, or none."""
        emotion = emotion or NEUTRAL
        self._idle.feel(emotion)
        self._neutral = region_of("neutral").contains(emotion)

    def sample(self, time: float) -> Pose:
        """Return the pose at a time [s]; one long before the latest goes on from where it is."""
        self._clock += max(time - self._last, 0.0)
        self._last = time
        acting = self._machine.state != ""
        if acting and (not self._neutral or self._clock >= self._change):
            self._machine.request("", self._clock)
            self._change = self._clock + self._rng.uniform(*PAUSE_S)
        elif not acting and self._acts and self._clock >= self._change:
            self._change = self._clock + self._rng.uniform(*PAUSE_S)
            if self._neutral:
                name = [*self._acts][int(self._rng.integers(len(self._acts)))]
                self._machine.request(name, self._clock)
                self._change = self._clock + self._acts[name].duration - TRANSITION_S
        pose = self._machine.sample(self._clock)
        return pose if self._paws is None else self._paws.hold(pose)

    def travel(self, start: float, end: float) -> RootDelta:
        """Return no movement: the feet stay."""
        return RootDelta()
