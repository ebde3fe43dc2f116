"""A person who stands: her idle motion, and now and then an act.

Source: Egges, Molet and Magnenat-Thalmann 2004, section 4: besides balance shifts and small
variations there are acts, such as to touch one's hair, which are played as they were recorded.
It goes to the posture in which an act begins first (section 7.1).
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from cubeling.affect import NEUTRAL, Emotion
from cubeling.affect.regions import region_of
from cubeling.characters.ik.legs import LegFrames, LegIK, find_paws
from cubeling.characters.motion.clip import Clip
from cubeling.characters.motion.motion import RootDelta
from cubeling.characters.motion.state_machine import StateMachine
from cubeling.characters.skeleton.anatomy import Anatomy
from cubeling.characters.skeleton.pose import Array, Pose, Skeleton
from cubeling.characters.skeleton.scalar_quaternions import conjugate, multiply
from cubeling.characters.synthesis.idle.idle_motion import IdleMotion

PAUSE_S = 10.0, 24.0
"""Shortest and longest time between acts [s]."""

NEUTRAL_REGION = region_of("neutral")
"""Emotions that leave room for acts."""

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

    Acts are played while the emotion is neutral. One who begins to feel, or to speak, breaks them
    off. Paws may be planted here; feet are by a layer of the animator.
    """

    def __init__(
        self,
        idle: IdleMotion,
        acts: Sequence[Clip],
        seed: int = 0,
        paws: PlantedPaws | None = None,
    ) -> None:
        self._paws = paws
        self.idle = idle
        """Her idle motion between acts."""
        self._acts = {clip.name: clip for clip in acts}
        self._machine = StateMachine({"": idle, **self._acts}, "", TRANSITION_S)
        self._rng = np.random.default_rng([seed, 1])
        self._neutral, self._talking, self._awaits = True, False, False
        self._next = ""  # the act that it goes to
        self._clock = self._last = 0.0  # played, and asked for last [s]
        self._change = self._rng.uniform(*PAUSE_S)  # when something else begins [s]

    @property
    def duration(self) -> float:
        """Infinite: it goes on for as long as it is sampled."""
        return math.inf

    def feel(self, emotion: Emotion | None) -> None:
        """Show an emotion from now on, or none."""
        emotion = emotion or NEUTRAL
        self.idle.feel(emotion)
        self._neutral = NEUTRAL_REGION.contains(emotion)

    def talk(self, shift: bool | None) -> None:
        """Shift the weight when a speech asks for it, or not until then; None in silence."""
        self.idle.talk(shift)
        self._talking = shift is not None

    def await_act(self, first: Pose | None, within: float) -> None:
        """Go to the pose in which an act begins; see `StandingMotion`."""
        self._awaits = True
        if self._next or self._machine.state:
            self._go_on()
        self.idle.await_act(first, within)

    def go_on(self) -> None:
        """Shift the weight again after `await_act`."""
        self._awaits = False
        self.idle.go_on()

    def sample(self, time: float) -> Pose:
        """Return the pose at a time [s]; one long before the latest goes on from where it is."""
        self._clock += max(time - self._last, 0.0)
        self._last = time
        occupied = self._next != "" or self._machine.state != ""
        if self._clock >= self._change or (occupied and not self._free):
            self._go_on()
        pose = self._machine.sample(self._clock)
        return pose if self._paws is None else self._paws.hold(pose)

    @property
    def _free(self) -> bool:
        """Whether it may play acts."""
        return self._neutral and not self._talking and not self._awaits

    def _go_on(self) -> None:
        """Go to an act, then play it, then stand; who feels or speaks only stands."""
        ended, ready = self._machine.state, self._next
        self._next = ""
        lasts = self._rng.uniform(*PAUSE_S)
        if ended:
            self._machine.request("", self._clock)
            self.idle.begin_at(self._vectors(self._acts[ended], -1 if self._free else 0))
        elif not self._free:
            self.idle.go_on()
        elif ready:
            self._machine.request(ready, self._clock)
            lasts = self._acts[ready].duration - TRANSITION_S
        elif self._acts:
            self._next = [*self._acts][int(self._rng.integers(len(self._acts)))]
            lasts = self.idle.lead_to(self._vectors(self._acts[self._next], 0))
        self._change = self._clock + lasts

    def _vectors(self, act: Clip, frame: int) -> Array:
        """Return the posture vector of a frame of an act."""
        return self.idle.database.kind.vectors(act.poses[frame])

    def travel(self, start: float, end: float) -> RootDelta:
        """Return no movement: the feet stay."""
        return RootDelta()
