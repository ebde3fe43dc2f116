"""A scenario that is a dialogue: what is typed, and what the cube does, is answered."""

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from textwrap import shorten
from typing import ClassVar

from cubeling.affect import Personality
from cubeling.app.errors import AppError
from cubeling.app.pipeline.scenario import Inputs, Outcome, Reply, ScenarioSettings
from cubeling.app.pipeline.table.situation import PLAYER_POSITION, Situation
from cubeling.app.scenarios.dialogue.asking import PendingQuestion
from cubeling.app.scenarios.dialogue.cube_words import CubeWords
from cubeling.app.scenarios.dialogue.reply_progress import ReplyProgress
from cubeling.app.scenarios.dialogue.vocabulary import TALK_VOCABULARY
from cubeling.app.scenarios.mood import MoodController
from cubeling.app.scenarios.presence import Presence
from cubeling.app.scenarios.rules.file import USUAL_ACTING_S
from cubeling.app.scenarios.rules.scenario import HOME, way_of
from cubeling.app.scenarios.rules.vocabulary import ACTIONS, Intent, Moment
from cubeling.characters import ActionIntent, CharacterCommand, LocomotionIntent
from cubeling.characters.behaviour import (
    Dialogue,
    DialogueScript,
    DialogueTurn,
    read_script,
)
from cubeling.characters.speech import TaggedText
from cubeling.tracking import CubeControls, CubeModel

BUNDLED_SCRIPT = Path(__file__).with_name("vleo.xml")
"""The script of the scenario `talk`."""

HEARD_S, SHOWN_LETTERS = 6.0, 60
"""How long the picture shows what was typed [s], and how many letters of it."""

TYPING_S = 8.0
"""Who has begun to type and says nothing more is listened to for so long [s]."""

HINT = "Type to talk, and press Enter"


class DialogueScenario:
    """Answers by the script of its class, which `dialogue_scenario` makes of a file.

    What is typed and what the cube does is heard in the order in which it comes. A new line, a
    player who begins to type, and a lifted cube cut off what is being said.
    """

    script: ClassVar[DialogueScript]
    """What can be said."""

    conversation: ClassVar[DialogueScript]
    """The same; see `ConversingScenario`."""

    asked: ClassVar[Mapping[str, str]]
    """See `AskingScenario`."""

    gestures: ClassVar[Mapping[str, str]]
    """See `GesturingScenario`."""

    name: str
    summary: str
    cube = "companion"
    roles: tuple[str, ...] = ()
    character: str
    personality: str
    start = HOME
    has_intensity = False
    adjustable = ("personality",)
    listens = True

    def __init__(self, cube: CubeModel, settings: ScenarioSettings) -> None:
        self._cube, self._language = cube, settings.language
        self._roles = {face.name: face.role for face in cube.faces}
        if settings.language not in ("", *self.script.languages):
            known = ", ".join(self.script.languages)
            raise AppError(
                f"{self.script.name} does not speak '{settings.language}'; it has {known}"
            )
        self._mood = MoodController(settings.personality or Personality.load(self.personality))
        self._presence = Presence()
        self._asks_model = settings.asks_model
        self._begin()

    @property
    def language(self) -> str:
        """Code of the language that is spoken now."""
        return self._dialogue.state.language

    def adjust(self, settings: ScenarioSettings) -> None:
        """Play on with another personality."""
        self._mood.adjust(settings.personality or Personality.load(self.personality))

    def _begin(self) -> None:
        self._dialogue = Dialogue(self.script, language=self._language, vocabulary=TALK_VOCABULARY)
        self._words = CubeWords(self._cube)
        self._reply = ReplyProgress()
        self._question = PendingQuestion()
        self._typed, self._typed_at = "", 0.0
        self._listens_until = 0.0
        self._intent, self._acts_until = Intent(hint=HINT), 0.0

    def update(self, controls: CubeControls, situation: Situation, inputs: Inputs) -> Outcome:
        """Decide on one frame; see `Scenario.update`."""
        now = controls.timestamp
        if inputs.clear:
            self._mood.reset()
            self._begin()
        visible = self._presence.update(controls)
        words = self._words.update(controls)
        hush = inputs.hush or bool(inputs.typed) or "the cube was lifted" in words
        hush |= inputs.line is not None and not self._reply.begin(inputs.line, now)
        hush |= not visible
        self._remember(self._reply.stop(now) if hush else self._reply.finished(now))
        self._listen(inputs, words, now)
        self._question.take(inputs.answer, now)
        moment = Moment(controls, situation, inputs, self._roles)
        answers = bool(self._question.text)
        turn = self._answer(moment) if visible else None
        question = reply = None
        if turn is not None and turn.is_question:
            question = self._question.ask(turn.heard, now)
        if turn is not None and turn.text:
            reply = Reply(turn.text, turn.language, answers and not self._question.is_open)
        elif visible:
            filler = self._question.filler(self.language, now)
            reply = Reply(filler, self.language, is_answer=True) if filler else None
        if reply is not None:
            self._remember(self._reply.stop(now))
            self._reply.ask(now)
            hush = True
        influences = () if turn is None else turn.influences
        outcome = self._outcome(moment, influences, visible, reply, hush)
        return replace(outcome, question=question, thinks=self._question.looks_aside(now))

    def _remember(self, heard: str) -> None:
        """Let the dialogue remember what was heard of a reply, if anything was."""
        if heard:
            self._dialogue.remember_said(heard)

    def _listen(self, inputs: Inputs, words: tuple[str, ...], now: float) -> None:
        """Take what is typed and what the cube does."""
        if inputs.hush:
            self._listens_until = now + TYPING_S
        if inputs.typed:
            self._question.drop()
            self._typed, self._typed_at, self._listens_until = inputs.typed, now, now
            self._dialogue.hear(inputs.typed)
        for each in words:
            self._dialogue.hear(each, typed=False)

    def _answer(self, moment: Moment) -> DialogueTurn | None:
        """Let the dialogue take its turn, and do what it says."""
        now = moment.controls.timestamp
        busy = self._reply.is_busy(now) or now < self._listens_until
        if self._question.is_open:
            text = self._question.text
            if text is None or busy:
                return None  # it thinks, says so to the end, or listens
            self._question.drop()
            if text:
                return self._dialogue.answer(text, now)
            self._dialogue.take_back()
            asks = False
        else:
            asks = self._asks_model
        turn = self._dialogue.update(
            now, busy=busy, feelings=self._mood.intensities, world=moment, asks=asks
        )
        if turn is not None and turn.acts:
            self._intent, self._acts_until = Intent(hint=HINT), now + USUAL_ACTING_S
            for name, text in turn.acts:
                ACTIONS[name].perform(self._intent, text)
        return turn

    def _outcome(
        self,
        moment: Moment,
        influences: tuple[tuple[str, float], ...],
        visible: bool,
        reply: Reply | None,
        hush: bool,
    ) -> Outcome:
        controls, intent = moment.controls, self._intent
        now = controls.timestamp
        felt = (*intent.events, *moment.inputs.events)
        intent.events.clear()
        acts = now < self._acts_until
        action = intent.action if acts else "idle"
        emotion = self._mood.update(
            controls, action if visible else "idle", events=felt, influences=influences
        )
        goes = acts and bool(intent.go)
        command = CharacterCommand(
            timestamp=now,
            locomotion=way_of(intent, moment, self.start)
            if acts
            else LocomotionIntent(facing=PLAYER_POSITION),
            action=None if goes else ActionIntent(action, 1.0 if acts else 0.0),
            visible=visible,
        )
        return Outcome(
            command,
            emotion,
            self._hint(controls),
            action if action != "idle" else "talk" if self._reply.speaks else "listen",
            reply=reply,
            hush=hush,
        )

    def _hint(self, controls: CubeControls) -> str:
        """Return what was typed, at once; after a while, what the player can do."""
        if self._typed and controls.timestamp - self._typed_at < HEARD_S:
            return f"“{shorten(self._typed, SHOWN_LETTERS, placeholder='…')}”"
        return self._intent.hint if controls.visible else "Show me the cube"


def dialogue_scenario(path: str | Path, name: str | None = None) -> type[DialogueScenario]:
    """Return the scenario of a script, called as its file is; CharacterError if it is refused."""
    script = read_script(path, TALK_VOCABULARY)
    asked: dict[str, str] = {}
    for action in script.actions("do"):
        if action.argument not in ("idle", "move"):
            asked.setdefault(action.argument, script.place(action.line))
    gestures: dict[str, str] = {}
    for action in script.actions("say"):
        for _, text in action.argument:
            for span in TaggedText.read(text).spans:
                gestures.setdefault(span.name, script.place(action.line))
    folder = Path(path).parent
    members = {
        "__module__": __name__,
        "__doc__": script.summary,
        "script": script,
        "conversation": script,
        "asked": asked,
        "gestures": gestures,
        "name": name or str(path),
        "summary": script.summary,
        "character": _beside(folder, script.character),
        "personality": _beside(folder, script.personality),
    }
    return type("FileDialogue", (DialogueScenario,), members)


def _beside(folder: Path, name: str) -> str:
    """Return a bundled name, or where a file is that stands beside the script."""
    return str(folder / name) if Path(name).suffix else name
