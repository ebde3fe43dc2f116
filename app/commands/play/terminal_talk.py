"""A talk in the terminal: the dialogue alone, without a picture and without a voice."""

from collections.abc import Iterable

import typer

from cubeling.affect import Feelings, Personality
from cubeling.app.errors import AppError
from cubeling.app.pipeline.scenario import Scenario
from cubeling.app.scenarios.dialogue.scenario import DialogueScenario
from cubeling.app.scenarios.dialogue.vocabulary import TALK_VOCABULARY
from cubeling.characters.behaviour import Dialogue
from cubeling.characters.speech import TaggedText

GREETING_S, STEP_S = 60.0, 0.5
"""So long the first line is waited for at most, and the time between two looks [s]; it costs none,
as there is no clock: who speaks first does so at once."""


def talk_in_terminal(
    scenario: type[Scenario], lines: Iterable[str], language: str, seed: int = 0
) -> None:
    """Print what is answered to lines, until they end.

    Raises AppError if the script does not speak a language.
    """
    assert issubclass(scenario, DialogueScenario)
    script = scenario.script
    if language not in ("", *script.languages):
        raise AppError(f"{script.name} does not speak '{language}'")
    dialogue = Dialogue(script, language=language, seed=seed, vocabulary=TALK_VOCABULARY)
    feelings = Feelings(Personality.load(scenario.personality))
    now = 0.0
    while now < GREETING_S and not _answer(dialogue, feelings, now):
        now += STEP_S
    for line in lines:
        if line.strip():
            now += STEP_S
            dialogue.hear(line)
            _answer(dialogue, feelings, now)


def _answer(dialogue: Dialogue, feelings: Feelings, now: float) -> bool:
    """Print what is said at a time [s], and return whether it is something."""
    feelings.update("idle", 0.0, now)
    turn = dialogue.update(now, feelings=feelings.intensities)
    if turn is None:
        return False
    for word, value in turn.influences:
        feelings.influence(word, value)
    if turn.text:
        text = TaggedText.read(turn.text).text
        dialogue.remember_said(text)
        typer.echo(text)
    return bool(turn.text)
