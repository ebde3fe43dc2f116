"""A talk in the terminal: the dialogue alone, without a picture and without a voice."""

from collections.abc import Iterable
from typing import TYPE_CHECKING

import typer

from cubeling.affect import Feelings, Personality
from cubeling.app.errors import AppError
from cubeling.app.scenarios import find_scenario
from cubeling.app.scenarios.dialogue.scenario import DialogueScenario
from cubeling.app.scenarios.dialogue.vocabulary import TALK_VOCABULARY
from cubeling.app.session import SessionOptions
from cubeling.app.speaking.model.protocol import ModelError
from cubeling.characters.behaviour import Dialogue
from cubeling.characters.speech import TaggedText

if TYPE_CHECKING:
    from cubeling.app.speaking.model.chat import ChatModel

GREETING_S, STEP_S = 60.0, 0.5
"""So long the first line is waited for at most, and the time between two looks [s]; it costs none,
as there is no clock: who speaks first does so at once."""


def talk_in_terminal(options: SessionOptions, lines: Iterable[str], seed: int = 0) -> None:
    """Print what is answered to lines, until they end.

    Raises AppError if the script does not speak a language, or a model has no usable address.
    """
    scenario, language = find_scenario(options.scenario), options.talk_language
    assert issubclass(scenario, DialogueScenario)
    script = scenario.script
    if language not in ("", *script.languages):
        raise AppError(f"{script.name} does not speak '{language}'")
    dialogue = Dialogue(script, language=language, seed=seed, vocabulary=TALK_VOCABULARY)
    feelings = Feelings(Personality.load(scenario.personality))
    model = None
    if options.model is not None:
        from cubeling.app.speaking.model.chat import ChatModel

        model = ChatModel(options.model, options.model_name, script, scenario.gestures)
    now = 0.0
    while now < GREETING_S and not _answer(dialogue, feelings, now, model):
        now += STEP_S
    for line in lines:
        if line.strip():
            now += STEP_S
            dialogue.hear(line)
            _answer(dialogue, feelings, now, model)


def _answer(dialogue: Dialogue, feelings: Feelings, now: float, model: "ChatModel | None") -> bool:
    """Print what is said at a time [s], and return whether it is something."""
    feelings.update("idle", 0.0, now)
    turn = dialogue.update(now, feelings=feelings.intensities, asks=model is not None)
    by_model = turn is not None and turn.is_question
    if turn is not None and model is not None and by_model:
        try:
            turn = dialogue.answer(model.reply(turn.heard, feelings.emotion), now)
            notice = model.note
        except ModelError as error:
            notice = f"{error}; the script answers"
            dialogue.take_back()
            turn, by_model = dialogue.update(now, feelings=feelings.intensities), False
        if notice:
            typer.echo(notice, err=True)
    if turn is None:
        return False
    for word, value in turn.influences:
        feelings.influence(word, value)
    if turn.text:
        text = TaggedText.read(turn.text).text
        dialogue.remember_said(text)
        if model is not None and not by_model:
            model.remember(text)
        typer.echo(text)
    return bool(turn.text)
