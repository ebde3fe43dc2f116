"""Actions: what a character can perform besides standing and walking, at any intensity."""

from collections.abc import Iterable, Iterator, Mapping

from cubeling.characters.control.command import ActionIntent, ComingAct
from cubeling.characters.errors import CharacterError
from cubeling.characters.face.affect_display import EMOTIONAL_WORDS
from cubeling.characters.model.character import Character
from cubeling.characters.motion.blend import BlendSpace1D
from cubeling.characters.motion.clip import Clip
from cubeling.characters.motion.phase import PhasedMotion, RetimedMotion
from cubeling.characters.motion.state_machine import StateMachine
from cubeling.characters.skeleton.pose import Pose

WEIGHT_OF_SUFFIX = {"head": -1.0, "legs": 0.0, "tail": 1.0}
"""Weights that the suffixes of an action's clips stand for (thesis, section 5.3)."""

WEIGHT_LAG_S = 0.12
"""Time constant with which the intensity of an action follows the command [s]."""


class ActionMotion(RetimedMotion):
    """An action whose intensity may change while it plays; a `Motion`.

    Its clips lie in `space` over the intensity and start together. With `once` it ends; otherwise
    it repeats.
    """

    def __init__(self, name: str, space: BlendSpace1D, once: bool) -> None:
        self.shows_emotion = name in EMOTIONAL_WORDS
        """Whether its clips show an emotion themselves: it is named after one."""
        super().__init__(space.at(0.0))
        self._space = space
        self._once = once

    def begin(self, weight: float) -> None:
        """Restart at time 0, at an intensity −1…1."""
        self.restart(self._space.at(weight), 0.0)

    def set_weight(self, weight: float, time: float) -> None:
        """Continue at another intensity from a time on [s]."""
        phase = self.phase(time)
        self.change(self._space.at(weight), time)
        if self._once:
            self._phase = phase  # not wrapped: an action that has ended stays at its end

    def over(self, time: float) -> bool:
        """Whether it has ended at a time [s]."""
        return self._once and self.phase(time) >= 1.0

    @property
    def clip(self) -> Clip:
        """Its clip of middle intensity, or the one nearest to it."""
        motions = self._space.motions
        middle = motions[len(motions) // 2]
        assert isinstance(middle, PhasedMotion)
        assert isinstance(middle.motion, Clip)
        return middle.motion

    def phase(self, time: float) -> float:
        """Return the phase at a time [s]; an action that has ended stays at 1."""
        phase = super().phase(time) if self.duration > 0.0 else self._phase
        return min(phase, 1.0) if self._once else phase


def clips_of_actions(
    clips: Iterable[str], besides: Iterable[str] = ()
) -> dict[str, dict[float, str]]:
    """Return the clips of each action by intensity.

    An action X is the clips X_head, X_legs and X_tail, for weights −1, 0 and 1. A clip without
    such a suffix is an action of one intensity. "idle" and the clips `besides` are no actions.

    >>> clips_of_actions(["idle", "kiss_head", "kiss_tail", "nod"])
    {'kiss': {-1.0: 'kiss_head', 1.0: 'kiss_tail'}, 'nod': {0.0: 'nod'}}
    """
    known, others = list(clips), {"idle", *besides}
    actions: dict[str, dict[float, str]] = {}
    for name in known:
        action, _, suffix = name.rpartition("_")
        if not action or suffix not in WEIGHT_OF_SUFFIX:
            action = name
        if action in actions or action in others or name in others:
            continue
        found = {
            weight: f"{action}_{suffix}"
            for suffix, weight in WEIGHT_OF_SUFFIX.items()
            if f"{action}_{suffix}" in known
        }
        actions[action] = found or {0.0: name}
    return actions


class Actions(Mapping[str, ActionMotion]):
    """The actions of a character by name; see `clips_of_actions`.

    One is made when it is first played.
    """

    def __init__(self, character: Character, besides: Iterable[str] = ()) -> None:
        self._character = character  # its clips may be lent, and are made when they are asked for
        self._names = clips_of_actions(character.clips, besides)
        self._made: dict[str, ActionMotion] = {}

    def __getitem__(self, action: str) -> ActionMotion:
        if action not in self._made:
            names = self._names[action]
            clips = [self._character.clips[name] for name in names.values()]
            space = BlendSpace1D(tuple(names), tuple(PhasedMotion(clip) for clip in clips))
            once = not any(clip.loop for clip in clips)
            self._made[action] = ActionMotion(action, space, once)
        return self._made[action]

    def first_pose(self, coming: ComingAct | None) -> Pose | None:
        """Return the pose in which what comes begins; None if it is no action."""
        if coming is None or coming.action not in self:
            return None
        return self[coming.action].clip.poses[0]

    def __iter__(self) -> Iterator[str]:
        return iter(self._names)

    def __len__(self) -> int:
        return len(self._names)

    def __contains__(self, action: object) -> bool:
        return action in self._names  # a Mapping's own would make the action


def next_action(
    machine: StateMachine,
    actions: Mapping[str, ActionMotion],
    intent: ActionIntent | None,
    finished: str,
    now: float,
) -> tuple[str, str]:
    """Return the action to play for an intent, and the asked action that has finished.

    An action that ends is followed by "idle" for as long as the same action is asked for.

    Raises
    ------
    CharacterError
        If the character does not know the action.
    """
    asked = "idle" if intent is None or intent.name == "move" else intent.name
    if asked != "idle" and asked not in actions:
        raise CharacterError(
            f"the character does not know {asked!r}; it knows {', '.join(machine.states)}"
        )
    if asked != finished:
        finished = ""
    if asked == machine.state and asked in actions and actions[asked].over(now - machine.entered):
        finished = asked
    return ("idle" if finished else asked), finished
