"""A character that does what it is told beside its scenario."""

from collections.abc import Collection
from dataclasses import replace

import numpy as np

from cubeling.affect import Emotion
from cubeling.app.pipeline.scenario import EmotionTarget, Inputs, Outcome, Reply
from cubeling.app.pipeline.table.acts import ACTION_S, MAX_PLACE_M, MAX_SAID_CHARS, Act
from cubeling.app.pipeline.table.situation import PLAYER_POSITION
from cubeling.characters import (
    ActionIntent,
    Character,
    CharacterError,
    GestureCalls,
    LocomotionIntent,
    meanings_of,
)
from cubeling.characters.speech import TaggedText

GOING_SPEED = 2.0
"""AvatAR's Speed of a character that is sent somewhere: it walks."""


class Directing:
    """Puts acts in the place of what a scenario decides for one character."""

    def __init__(self, character: Character) -> None:
        self._action: ActionIntent | None = None
        self._until = 0.0
        self._emotion: Emotion | None = None
        self._place: tuple[float, float] | None = None
        self._said = ""
        self._noted: dict[str, int] = {}  # the number of the last act of each kind
        self.take(character)

    def take(self, character: Character) -> None:
        """Go on with another body."""
        self._gestures = GestureCalls(character)

    def update(self, decision: Outcome, inputs: Inputs) -> Outcome:
        """Return a decision with what the acts of its frame, and those before, ask for."""
        now = decision.command.timestamp
        if inputs.clear:
            self._action = self._emotion = self._place = None
        for act in inputs.acts:
            self._begin(act, now)
            if act.kind == "undo" and act.note is not None:
                ended = self._undo(act.note.number)
                decision = replace(decision, hush=decision.hush or ended == "say")
            if act.kind == "say":
                decision = replace(decision, reply=Reply(act.text, ""), hush=True)
        if inputs.line is not None and inputs.line.utterance.text == self._said:
            # A dialogue would cut off the line, which none of its replies is.
            decision, self._said = replace(decision, hush=False), ""
        if self._action is not None and now >= self._until:
            self._action = None
        command, behaviour = decision.command, self._gestures.intent(now)
        if self._place is not None:
            # The action of a scenario that only stands would keep it from going.
            going = LocomotionIntent(GOING_SPEED, np.array(self._place), facing=PLAYER_POSITION)
            command = replace(command, locomotion=going, action=None)
        if self._action is not None:
            command = replace(command, action=self._action)
            decision = replace(decision, icon=self._action.name)
        if behaviour is not None:
            command = replace(command, behaviour=behaviour.joined(command.behaviour))
        if self._emotion is not None:
            target = EmotionTarget(self._emotion, decision.emotion.timestamp)
            decision = replace(decision, emotion=target)
        return replace(decision, command=command)

    def _begin(self, act: Act, now: float) -> None:
        if act.kind == "action":
            ends = act.text == "idle"
            self._action = None if ends else ActionIntent(act.text, act.weight)
            self._until = now + ACTION_S
        elif act.kind == "gesture":
            self._gestures.begin(act.text, now)
        elif act.kind == "say":
            self._said = TaggedText.read(act.text).text
        elif act.kind == "emotion":
            self._emotion = act.emotion
        elif act.kind == "go":
            self._place = act.place
        if act.note is not None and act.kind not in ("undo", "cue"):
            self._noted[act.kind] = act.note.number

    def _undo(self, number: int) -> str:
        """End what the act of a number still does, and return its kind; "" for nothing."""
        kind = next((kind for kind, last in self._noted.items() if last == number), "")
        if kind == "action":
            self._action = None
        elif kind == "emotion":
            self._emotion = None
        elif kind == "go":
            self._place = None
        return kind


def refusal(act: Act, character: Character, actions: Collection[str]) -> str:
    """Return why a character cannot do something, in one line; "" if it can."""
    if act.kind == "action" and act.text not in ("idle", *actions):
        known = ", ".join(actions) or "none"
        return f"{character.name} has no action '{act.text:.40}'; its actions: {known}"
    if act.kind == "gesture" and not meanings_of(character, (act.text,)):
        return f"{character.name} has no gesture '{act.text:.40}'"
    if act.kind == "go" and not all(abs(each) <= MAX_PLACE_M for each in act.place or ()):
        return f"a place is at most {MAX_PLACE_M:g} m from the middle of the table"
    if act.kind == "say":
        try:
            TaggedText.read(act.text)
        except CharacterError as error:
            return f"nothing is said: {error}"
        if not 0 < len(act.text) <= MAX_SAID_CHARS:
            return f"what is said has 1 to {MAX_SAID_CHARS} characters, not {len(act.text)}"
    return ""
