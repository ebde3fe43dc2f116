"""A character that does what it is told beside its scenario."""

from collections.abc import Collection
from dataclasses import replace

from cubeling.affect import Emotion
from cubeling.app.pipeline.scenario import EmotionTarget, Inputs, Outcome, Reply
from cubeling.app.pipeline.table.acts import ACTION_S, MAX_SAID_CHARS, Act
from cubeling.characters import (
    ActionIntent,
    Character,
    CharacterError,
    GestureCalls,
    meanings_of,
)
from cubeling.characters.speech import TaggedText


class Directing:
    """Puts acts in the place of what a scenario decides for one character."""

    def __init__(self, character: Character) -> None:
        self._action: ActionIntent | None = None
        self._until = 0.0
        self._emotion: Emotion | None = None
        self._said = ""
        self.take(character)

    def take(self, character: Character) -> None:
        """Go on with another body."""
        self._gestures = GestureCalls(character)

    def update(self, decision: Outcome, inputs: Inputs) -> Outcome:
        """Return a decision with what the acts of its frame, and those before, ask for."""
        now = decision.command.timestamp
        if inputs.clear:
            self._action = self._emotion = None
        for act in inputs.acts:
            self._begin(act, now)
            if act.kind == "say":
                decision = replace(decision, reply=Reply(act.text, ""), hush=True)
        if inputs.line is not None and inputs.line.utterance.text == self._said:
            # A dialogue would cut off the line, which none of its replies is.
            decision, self._said = replace(decision, hush=False), ""
        if self._action is not None and now >= self._until:
            self._action = None
        command, behaviour = decision.command, self._gestures.intent(now)
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
        else:
            self._emotion = act.emotion


def refusal(act: Act, character: Character, actions: Collection[str]) -> str:
    """Return why a character cannot do something, in one line; "" if it can."""
    if act.kind == "action" and act.text not in ("idle", *actions):
        known = ", ".join(actions) or "none"
        return f"{character.name} has no action '{act.text:.40}'; its actions: {known}"
    if act.kind == "gesture" and not meanings_of(character, (act.text,)):
        return f"{character.name} has no gesture '{act.text:.40}'"
    if act.kind == "say":
        try:
            TaggedText.read(act.text)
        except CharacterError as error:
            return f"nothing is said: {error}"
        if not 0 < len(act.text) <= MAX_SAID_CHARS:
            return f"what is said has 1 to {MAX_SAID_CHARS} characters, not {len(act.text)}"
    return ""
