"""A scenario that is a play: one for each of the cast, which share where it is."""

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import ClassVar

from cubeling.affect import Personality
from cubeling.app.pipeline.scenario import (
    OVER_EVENT,
    Inputs,
    Outcome,
    Reply,
    Scenario,
    ScenarioSettings,
)
from cubeling.app.pipeline.table.situation import PLAYER_POSITION, Situation
from cubeling.app.pipeline.table.stage_sounds import SoundSource
from cubeling.app.scenarios.dialogue.scenario import DialogueScenario, dialogue_scenario
from cubeling.app.scenarios.mood import MoodController
from cubeling.app.scenarios.presence import Presence
from cubeling.app.scenarios.rules.scenario import HOME
from cubeling.app.show.block_player import BlockPlayer
from cubeling.app.show.script import ShowCue, ShowScript, read_show
from cubeling.app.show.stage_state import StageState
from cubeling.characters import ActionIntent, CharacterCommand, LocomotionIntent, RootDelta
from cubeling.characters.behaviour import DialogueScript
from cubeling.characters.speech import TaggedText
from cubeling.tracking import CubeControls, CubeModel

BACK_S = 10.0
"""When nobody has said anything for so long, the play goes on that a player had interrupted [s]."""


class ShowScenario:
    """Plays one of the cast by the file of its class, which `show_scenario` makes.

    Of the first one it makes those of the others (`CastDirector`). Where the file ends with a
    dialogue, that takes over with its cue, or for a while as soon as the player types or speaks:
    the first character answers from where it is.

    Parameters
    ----------
    cube, settings
        As of every scenario.
    who
        The number of the character in the cast.
    start
        Where it stands at first.
    stage
        What the cast shares; None to make it.
    """

    script: ClassVar[ShowScript]
    """What its file says."""

    asked: ClassVar[Mapping[str, str]]
    """See `AskingScenario`."""

    gestures: ClassVar[Mapping[str, str]]
    """See `GesturingScenario`."""

    sounds: ClassVar[Mapping[str, SoundSource]]
    """See `SoundingScenario`."""

    dialogue: ClassVar[type[DialogueScenario] | None]
    """What takes over; None for nothing."""

    conversation: ClassVar[DialogueScript | None]
    """The script of that; see `ConversingScenario`."""

    name: str
    summary: str
    cube = "companion"
    roles: tuple[str, ...] = ()
    character: str
    others: tuple[str, ...]
    names: tuple[str, ...]
    colours: tuple[Mapping[str, str], ...]
    personality = "heartfelt"
    has_intensity = False
    adjustable: tuple[str, ...] = ()
    listens = True

    def __init__(
        self,
        cube: CubeModel,
        settings: ScenarioSettings,
        who: int = 0,
        start: RootDelta = HOME,
        stage: StageState | None = None,
    ) -> None:
        self.start = start
        self._cube, self._settings, self._who = cube, settings, who
        self._stage = stage or StageState(self.script)
        self._presence = Presence()
        self._mood = MoodController(Personality.load(self.personality))
        self._saying: ShowCue | None = None
        self._spoken = True
        self._blocks: BlockPlayer | None = None
        self._coming: list[ShowCue] = []
        self._talk: DialogueScenario | None = None
        self._talked_at = 0.0

    @property
    def language(self) -> str:
        """Code of the language in which it answers now."""
        first = (
            self.script.language if self.conversation is None else self.conversation.languages[0]
        )
        return first if self._talk is None else self._talk.language

    @property
    def prepares(self) -> bool:
        """Whether a block of BML waits for lines, which it begins by itself when they are there."""
        return self._blocks is not None and self._blocks.lines.waits

    def scenario_of(self, number: int, place: RootDelta) -> Scenario | None:
        """Return what one of the others plays; see `CastDirector`."""
        if number >= len(self.script.cast):
            return None
        return type(self)(self._cube, self._settings, number, place, self._stage)

    def update(self, controls: CubeControls, situation: Situation, inputs: Inputs) -> Outcome:
        """Decide on one frame; see `Scenario.update`."""
        stage = self._stage
        stage.clips.update(inputs.sounds)
        outcome = self._decide(controls, situation, inputs)
        if self._who:
            return outcome
        missing = tuple(name for name in self.sounds if name not in stage.clips)
        return replace(outcome, asked_sounds=missing, sounds=stage.sounds(controls.timestamp))

    def _decide(self, controls: CubeControls, situation: Situation, inputs: Inputs) -> Outcome:
        now, visible, stage = controls.timestamp, self._presence.update(controls), self._stage
        if inputs.clear:
            self._saying, self._blocks, self._coming = None, None, []
        if self._who == 0:
            if inputs.clear:
                self._begin_again()
            if (inputs.typed or inputs.hush) and self.dialogue is not None:
                stage.take_over(comes_back=True)
            if visible:
                stage.advance(now)
        if stage.talks and self._who == 0 and self.dialogue is not None:
            self._talk = self._talk or self.dialogue(self._cube, self._settings)
            self._blocks = None
            outcome = self._talk.update(controls, situation, inputs)
            if inputs.typed or inputs.hush or outcome.reply is not None or outcome.icon == "talk":
                self._talked_at = now
            if stage.comes_back and now - self._talked_at > BACK_S:
                stage.come_back(now)
            return outcome
        if self._saying is not None and inputs.line is not None and not self.prepares:
            stage.expect(self._saying, now + inputs.line.utterance.duration)
            self._spoken = True
        outcome = self._carry_out(controls, inputs, visible)
        return self._with_blocks(outcome, situation, inputs)

    def _begin_again(self) -> None:
        stage = self._stage
        stage.next, stage.since, stage.talks = 0, None, False
        stage.ongoing.clear()
        stage.orders.clear()
        self._talk = None

    def _carry_out(self, controls: CubeControls, inputs: Inputs, visible: bool) -> Outcome:
        now, reply, hush = controls.timestamp, None, False
        influences = []
        for cue in self._stage.take_orders(self._who):
            if cue.kind == "say":
                self._saying, self._spoken, hush = cue, False, True
                reply = Reply(cue.text, self.script.language)
            elif cue.kind == "feel":
                influences.append((cue.text, cue.value))
            elif cue.kind == "bml":
                self._coming.append(cue)
            elif cue.kind == "stop":
                if self._saying is not None and self._saying.id == cue.text:
                    self._saying, self._spoken, hush = None, True, True
                if self._blocks is not None:
                    self._blocks.stop(cue.text)
        acting = self._stage.acting(self._who, now)
        action = "idle" if acting is None else acting.cue.text
        # A fade leads from all of an action to the least of it.
        weight = 0.0 if acting is None else 2.0 * acting.share(now) - 1.0
        emotion = self._mood.update(
            controls, action if visible else "idle", weight, influences=influences
        )
        command = CharacterCommand(
            timestamp=now,
            locomotion=LocomotionIntent(facing=PLAYER_POSITION),
            action=ActionIntent(action, weight),
            visible=visible,
            coming=self._stage.coming(self._who, now),
        )
        hint = self.script.summary if controls.visible else "Show me the cube"
        events = (OVER_EVENT,) if self._stage.is_over(now) else ()
        silent = action != "idle" or not self._stage.speaks(self._who, now)
        icon = action if silent else "talk"
        return Outcome(command, emotion, hint, icon, events=events, reply=reply, hush=hush)

    def _with_blocks(self, outcome: Outcome, situation: Situation, inputs: Inputs) -> Outcome:
        """Return a decision with what the blocks add, from the frame on that shows the body."""
        body = situation.body
        if self._coming and body is not None:
            if self._blocks is None or self._blocks.character is not body.character:
                self._blocks = BlockPlayer(body.character, self.script.language)
            for cue in self._coming:
                self._blocks.begin(cue)
            self._coming = []
        if self._blocks is None:
            return outcome
        if outcome.reply is not None:
            self._blocks.lines.give_way()
        outcome = self._blocks.update(outcome, situation, inputs.line, self._stage)
        if outcome.reply is None and self._spoken:
            outcome = replace(outcome, reply=self._blocks.lines.next_reply())
        return outcome


def show_scenario(path: str | Path) -> type[ShowScenario]:
    """Return the scenario of a play; AppError or CharacterError if its file is refused."""
    script = read_show(path)
    asked: dict[str, str] = {}
    gestures: dict[str, str] = {}
    for cue in script.cues:
        if cue.kind == "do":
            asked.setdefault(cue.text, script.place(cue.line))
        for span in TaggedText.read(cue.text).spans if cue.kind == "say" else ():
            gestures.setdefault(span.name, script.place(cue.line))
    dialogue = dialogue_scenario(script.talk) if script.talk else None
    if dialogue is not None:
        asked, gestures = {**dialogue.asked, **asked}, {**dialogue.gestures, **gestures}
    first, *others = script.cast
    members = {
        "__module__": __name__,
        "__doc__": script.summary,
        "script": script,
        "asked": asked,
        "gestures": gestures,
        "sounds": script.sounds,
        "dialogue": dialogue,
        "conversation": None if dialogue is None else dialogue.script,
        "listens": dialogue is not None,
        "name": str(path),
        "summary": script.summary,
        "character": first.body,
        "others": tuple(each.body for each in others),
        "names": tuple(each.name for each in script.cast),
        "colours": tuple(each.colours for each in script.cast),
    }
    return type("FileShow", (ShowScenario,), members)
