"""Voices that answer with fixed times, and players that use them."""

import numpy as np

from cubeling.app.behaving.player import BehaviourPlayer
from cubeling.app.behaving.voice import PatientSource, line_of
from cubeling.app.pipeline.table.spoken_line import SpokenLine
from cubeling.characters import Character
from cubeling.characters.speech.speech import Speech, Word
from tests.bundled_characters import bundled_character

VOICE_HZ = 16_000
WORD_S = 0.5

HUMAN = bundled_character("human")


def speech_of(text: str, language: str) -> Speech:
    """Return a speech with a word every `WORD_S`, as loud all the time."""
    words, offset = [], 0
    for number, word in enumerate(text.split()):
        offset = text.index(word, offset)
        words.append(Word(word, number * WORD_S, (number + 0.8) * WORD_S, offset))
        offset += len(word)
    samples = np.full(round(len(words) * WORD_S * VOICE_HZ), 0.25, np.float32)
    return Speech(samples, VOICE_HZ, text, language, tuple(words))


class LateSource:
    """A voice that answers when it is told to."""

    def __init__(self) -> None:
        self.problem = ""
        self.ready = False

    def line(self, text: str, language: str) -> SpokenLine | None:
        return line_of(speech_of, text, language or "en") if self.ready else None

    def close(self) -> None:
        return


def player(character: Character = HUMAN, lines=None) -> BehaviourPlayer:
    """Return a player whose voice answers at once."""
    return BehaviourPlayer(character, lines or PatientSource(speech_of, "en"))


def block(inside: str, name: str = "b", head: str = "") -> str:
    """Return a BML document."""
    return (
        f'<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="{name}" {head}>{inside}</bml>'
    )
