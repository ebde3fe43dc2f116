"""What a character can be asked to do beside standing and walking, at any intensity."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

from characters.model.character import Character
from characters.motion.blend import BlendSpace1D
from characters.motion.clip import Clip
from characters.motion.contacts import find_contacts
from characters.motion.motion import RootDelta
from characters.motion.phase import PhasedMotion
from characters.motion.state_machine import StateMachine
from characters.skeleton.feet import Feet
from characters.skeleton.pose import Pose, Skeleton

INTENSITIES = (("head", -1.0), ("legs", 0.0), ("tail", 1.0))
"""Endings of an action's clips and the weights that they stand for (thesis, section 5.3)."""

WEIGHT_LAG = 0.12
"""How slowly the intensity of an action follows its wish [s]."""


@dataclass(frozen=True)
class Footing:
    """Which feet an action has on the ground, in each frame of its clip."""

    down: list[list[bool]]
    """(frames, feet)."""

    @staticmethod
    def of(clip: Clip, skeleton: Skeleton, feet: Feet) -> "Footing":
        """Return the footing that is found in a clip."""
        return Footing(find_contacts(clip, skeleton, feet).tolist())

    def at(self, phase: float) -> list[bool]:
        """Return which feet are down at a phase."""
        last = len(self.down) - 1
        frame = (phase if phase == 1.0 else phase % 1.0) * last
        return self.down[min(int(frame), last)]


class Act:
    """An action that plays at an intensity which may change meanwhile; a `Motion`.

    Parameters
    ----------
    space
        Its clips over the intensity, which start together.
    once
        Whether it ends; else it repeats.
    """

    def __init__(self, space: BlendSpace1D, once: bool) -> None:
        self._space = space
        self._once = once
        self._motion = space.at(0.0)
        self._phase = self._time = 0.0

    @property
    def duration(self) -> float:
        """How long it takes at the present intensity [s]."""
        return self._motion.duration

    def begin(self, weight: float) -> None:
        """Start over at time 0, at an intensity −1…1."""
        self._motion, self._phase, self._time = self._space.at(weight), 0.0, 0.0

    def change(self, weight: float, time: float) -> None:
        """Go on at another intensity from a time on [s]."""
        phase = self.phase(time)
        # Whole rounds are dropped, so that a long session does not lose precision.
        self._phase, self._time = phase if self._once else phase % 1.0, time
        self._motion = self._space.at(weight)

    def over(self, time: float) -> bool:
        """Whether it has ended by a time [s]."""
        return self._once and self.phase(time) >= 1.0

    def sample(self, time: float) -> Pose:
        """Return the pose at a time [s]."""
        return self._motion.at(self.phase(time))

    def travel(self, start: float, end: float) -> RootDelta:
        """Return how the root moves over the ground between two times [s]."""
        return self._motion.between(self.phase(start), self.phase(end))

    @property
    def clip(self) -> Clip:
        """Its clip of middle intensity, or the one nearest to it."""
        motions = self._space.motions
        middle = motions[min(len(motions) // 2, len(motions) - 1)]
        assert isinstance(middle, PhasedMotion)
        assert isinstance(middle.motion, Clip)
        return middle.motion

    def phase(self, time: float) -> float:
        """Return the phase at a time [s]."""
        phase = self._phase
        if self._motion.duration > 0.0:
            phase += (time - self._time) / self._motion.duration
        return min(phase, 1.0) if self._once else phase


def clips_of_acts(clips: Iterable[str], besides: Iterable[str] = ()) -> dict[str, dict[float, str]]:
    """Return the clips of each action by the intensity that they stand for.

    An action X is the clips X_head, X_legs and X_tail, for weights −1, 0 and 1. A clip without
    such an ending is an action of one intensity.

    >>> clips_of_acts(["idle", "kiss_head", "kiss_tail", "nod"])
    {'kiss': {-1.0: 'kiss_head', 1.0: 'kiss_tail'}, 'nod': {0.0: 'nod'}}

    Parameters
    ----------
    clips
        Names of all clips of a character.
    besides
        Clips that are something else, as "idle" is anyway.
    """
    known, others = list(clips), {"idle", *besides}
    acts: dict[str, dict[float, str]] = {}
    for name in known:
        action, _, ending = name.rpartition("_")
        if not action or ending not in dict(INTENSITIES):
            action = name
        if action in acts or action in others or name in others:
            continue
        there = {w: f"{action}_{e}" for e, w in INTENSITIES if f"{action}_{e}" in known}
        acts[action] = there or {0.0: name}
    return acts


def acts_of(character: Character, besides: Iterable[str] = ()) -> dict[str, Act]:
    """Return what a character knows to do; see `clips_of_acts`."""
    acts: dict[str, Act] = {}
    for action, names in clips_of_acts(character.clips, besides).items():
        clips = [character.clips[name] for name in names.values()]
        space = BlendSpace1D(tuple(names), tuple(PhasedMotion(clip) for clip in clips))
        acts[action] = Act(space, once=not any(clip.loop for clip in clips))
    return acts


def proceed(
    machine: StateMachine, acts: Mapping[str, Act], wish: str, done: str, now: float
) -> tuple[str, str]:
    """Return the action to play for a wish, and the one that was wished for and has ended.

    An action that ends is followed by "idle" for as long as the wish stays the same.
    """
    if wish != done:
        done = ""
    if wish == machine.state and wish in acts and acts[wish].over(now - machine.entered):
        done = wish
    return ("idle" if done else wish), done
