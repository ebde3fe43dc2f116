"""The layer that plays symbolic gestures: `CharacterCommand.behaviour.gestures`."""

from collections.abc import Sequence
from typing import TYPE_CHECKING

from cubeling.characters.behaviour.intents import BehaviourIntent, GestureIntent, Hand
from cubeling.characters.control.layers.gestures.sitting_up import STANDING_REST
from cubeling.characters.control.layers.layer import FrameContext
from cubeling.characters.model.character import Character
from cubeling.characters.skeleton.pose import Pose
from cubeling.characters.smoothing import SpringValue

if TYPE_CHECKING:
    from cubeling.characters.control.layers.gestures.playback import GesturePlayback

FADE_S = 0.3
"""How long a gesture takes to join in late, or to go that others cover [s]."""

ON_TIME_S = 0.05
"""A gesture that is first heard of so long after its start need not join in: a frame [s]."""

HANDS_FREE = {"idle": 1.0, "hop": 1.0, "walk": 1.0, "run": 0.5}
"""Share of gestures that is shown while a character does something; none in its actions."""

FREE_LAG_S = 0.4
"""Lag with which hands become free, and are taken [s]: what is laid over an action that takes over
may not go faster than the action."""

SHOWN_AT_ONCE = 4
"""Gestures that are performed at once, those that began last: they cover the others, and each costs
the time of planning its postures."""


class GestureLayer:
    """Performs gestures; it comes after speech, whose gestures it hides, and before gaze."""

    def __init__(self, character: Character, seed: int = 0) -> None:
        self._character = character
        self._active: list[GesturePlayback] = []
        self._free = SpringValue(1.0)

    def update(self, pose: Pose, context: FrameContext) -> Pose:
        """Return the pose with its gestures."""
        asked, now = context.command.behaviour, context.command.timestamp
        free = self._free.follow(self._hands_free(context), context.elapsed, FREE_LAG_S)
        if not self._active and (asked is None or not asked.gestures):
            return pose
        going = self._follow(asked or BehaviourIntent(), now)
        self._share_out(going, now, context.elapsed)
        for each in self._active:
            pose = each.over(pose, now, free)
        return pose

    def _hands_free(self, context: FrameContext) -> float:
        if self._character.anatomy.kind == "quadruped":
            return float(context.rest > STANDING_REST)
        return HANDS_FREE.get(context.frame.state, 0.0)

    def _follow(self, asked: BehaviourIntent, now: float) -> "set[GesturePlayback]":
        """Begin what is new and re-time what has changed; return what is asked for."""
        known = list(self._active)
        going: list[GesturePlayback] = []
        begun: list[GesturePlayback] = []
        for intent in asked.gestures:
            each = next((each for each in known if each.plays(intent)), None)
            if each is None:
                each = self._begin(intent, now, [*going, *known], asked)
                begun.append(each)
            else:
                known.remove(each)
            each.retime(intent, now)
            going.append(each)
        given_up = any(each.is_under_way(now) for each in known)
        for each in begun:
            each.takes_over = given_up
        self._active = [*known, *going]
        return set(going)

    def _share_out(self, going: "set[GesturePlayback]", now: float, elapsed: float) -> None:
        """Let join in what is asked for and not covered, and let go the rest."""
        under_way = [each for each in self._active if each.is_under_way(now)]
        covered = set(under_way[:-SHOWN_AT_ONCE])
        for each in self._active:
            if each in covered:
                each.cover(elapsed / FADE_S)
            elif each in going and not each.called_off:
                each.present = min(each.present + elapsed / FADE_S, 1.0)
            else:
                each.give_up(now, elapsed)
        self._active = [
            each
            for each in self._active
            if each in going or (each.present > 0.0 and not each.is_over(now))
        ]

    def _begin(
        self,
        intent: GestureIntent,
        now: float,
        others: "Sequence[GesturePlayback]",
        asked: BehaviourIntent,
    ) -> "GesturePlayback":
        # Most sessions have no gestures: what plans them is loaded with the first one.
        from cubeling.characters.behaviour.gestures.planning import GestureRealizer
        from cubeling.characters.control.layers.gestures.playback import GesturePlayback

        hand = intent.hand
        if hand == "nearest":
            hand = _free_hand(others, asked)
        on_time = now <= intent.times.start + ON_TIME_S
        return GesturePlayback(
            intent, hand, GestureRealizer.of(self._character), 1.0 if on_time else 0.0
        )


def prepare_gestures(character: Character) -> None:
    """Load what plans gestures and measure a body, so that its first gesture delays no frame."""
    import cubeling.characters.control.layers.gestures.playback  # noqa: F401
    from cubeling.characters.behaviour.gestures.planning import GestureRealizer

    GestureRealizer.of(character)


def _free_hand(others: "Sequence[GesturePlayback]", asked: BehaviourIntent) -> Hand:
    """Return the right hand, unless it is taken and the left one is not."""
    taken = {each.hand for each in others} | {each.hand for each in asked.reaches}
    return "left" if "right" in taken and not taken & {"left", "both"} else "right"
