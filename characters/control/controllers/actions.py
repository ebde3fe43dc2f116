"""Actions: what a character can perform besides standing and walking, at any intensity."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

from characters.face.affect_display import EMOTIONAL_WORDS
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
"""Suffixes of an action's clips and the weights that they stand for (thesis, section 5.3)."""

WEIGHT_LAG_S = 0.12
"""Time constant with which the intensity of an action follows the command [s]."""


@dataclass(frozen=True)
class ActionContacts:
    """Which feet an action has on the ground, in each frame of its clip."""

    down: list[list[bool]]
    """(frames, feet)."""

    @staticmethod
    def of(clip: Clip, skeleton: Skeleton, feet: Feet) -> "ActionContacts":
        """Return the contacts that are detected in a clip."""
        return ActionContacts(find_contacts(clip, skeleton, feet).tolist())

    def at(self, phase: float) -> list[bool]:
        """Return which feet are down at a phase."""
        last = len(self.down) - 1
        frame = (phase if phase == 1.0 else phase % 1.0) * last
        return self.down[min(int(frame), last)]


class ActionMotion:
    """An action whose intensity may change while it plays; a `Motion`.

    Parameters
    ----------
    name
        Its name.
    space
        Its clips over the intensity; they start together.
    once
        Whether it ends; otherwise it repeats.
    """

    def __init__(self, name: str, space: BlendSpace1D, once: bool) -> None:
        self.shows_emotion = name in EMOTIONAL_WORDS
        """Whether its clips show an emotion themselves: it is named after one."""
        self._space = space
        self._once = once
        self._motion = space.at(0.0)
        self._phase = self._time = 0.0

    @property
    def duration(self) -> float:
        """Duration at the present intensity [s]."""
        return self._motion.duration

    def begin(self, weight: float) -> None:
        """Restart at time 0, at an intensity −1…1."""
        self._motion, self._phase, self._time = self._space.at(weight), 0.0, 0.0

    def change(self, weight: float, time: float) -> None:
        """Continue at another intensity from a time on [s]."""
        phase = self.phase(time)
        # Whole cycles are dropped, so that a long session does not lose precision.
        self._phase, self._time = phase if self._once else phase % 1.0, time
        self._motion = self._space.at(weight)

    def over(self, time: float) -> bool:
        """Whether it has ended at a time [s]."""
        return self._once and self.phase(time) >= 1.0

    def sample(self, time: float) -> Pose:
        """Return the pose at a time [s]."""
        return self._motion.at(self.phase(time))

    def travel(self, start: float, end: float) -> RootDelta:
        """Return the motion of the root over the ground between two times [s]."""
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


def clips_of_actions(
    clips: Iterable[str], besides: Iterable[str] = ()
) -> dict[str, dict[float, str]]:
    """Return the clips of each action by intensity.

    An action X is the clips X_head, X_legs and X_tail, for weights −1, 0 and 1. A clip without
    such a suffix is an action of one intensity.

    >>> clips_of_actions(["idle", "kiss_head", "kiss_tail", "nod"])
    {'kiss': {-1.0: 'kiss_head', 1.0: 'kiss_tail'}, 'nod': {0.0: 'nod'}}

    Parameters
    ----------
    clips
        Names of all clips of a character.
    besides
        Clips that are not actions; "idle" never is one.
    """
    known, others = list(clips), {"idle", *besides}
    actions: dict[str, dict[float, str]] = {}
    for name in known:
        action, _, suffix = name.rpartition("_")
        if not action or suffix not in dict(INTENSITIES):
            action = name
        if action in actions or action in others or name in others:
            continue
        found = {w: f"{action}_{e}" for e, w in INTENSITIES if f"{action}_{e}" in known}
        actions[action] = found or {0.0: name}
    return actions


def actions_of(character: Character, besides: Iterable[str] = ()) -> dict[str, ActionMotion]:
    """Return the actions of a character by name; see `clips_of_actions`."""
    actions: dict[str, ActionMotion] = {}
    for action, names in clips_of_actions(character.clips, besides).items():
        clips = [character.clips[name] for name in names.values()]
        space = BlendSpace1D(tuple(names), tuple(PhasedMotion(clip) for clip in clips))
        actions[action] = ActionMotion(action, space, once=not any(clip.loop for clip in clips))
    return actions


def next_action(
    machine: StateMachine,
    actions: Mapping[str, ActionMotion],
    asked: str,
    finished: str,
    now: float,
) -> tuple[str, str]:
    """Return the action to play when `asked` for one, and the asked action that has finished.

    An action that ends is followed by "idle" for as long as the same action is asked for.
    """
    if asked != finished:
        finished = ""
    if asked == machine.state and asked in actions and actions[asked].over(now - machine.entered):
        finished = asked
    return ("idle" if finished else asked), finished
