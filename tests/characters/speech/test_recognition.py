"""Hearing a script's phrases in English speech, and nothing else."""

import importlib.util
import sys

import numpy as np
import pytest

from cubeling.characters import CharacterError
from cubeling.characters.speech import SpeechRecognizer, SpokenPhrase, espeak, listening_problem
from cubeling.characters.speech.voices.espeak import espeak_installed

RATE = 16_000

pytestmark = pytest.mark.skipif(
    not espeak_installed() or importlib.util.find_spec("pocketsphinx") is None,
    reason="eSpeak NG or PocketSphinx is not installed",
)

PHRASES = (
    SpokenPhrase((("yes",),)),
    SpokenPhrase((("tyrannosaurus",),), opens=True, closes=True),
    SpokenPhrase((("joke",),), opens=True, closes=True),
    SpokenPhrase((("my",), ("name",), ("is",), ("lucy", "tom")), opens=True, closes=True),
    SpokenPhrase((("im",), ("8",))),
    SpokenPhrase((("how",), ("old",), ("are",), ("you",))),
)


class Ears:
    """Hears what a voice says, with a little silence around it."""

    def __init__(self, voice):
        self.recognizer = SpeechRecognizer(PHRASES, voice)
        self._voice = voice

    def __call__(self, text, level=1.0):
        said = self._voice.say(text, "en-us")
        quiet = round(0.2 * said.rate)
        return self.recognizer.hear(level * np.pad(said.samples, quiet), said.rate)


@pytest.fixture(scope="module")
def heard():
    with espeak() as voice:
        yield Ears(voice)


@pytest.mark.slow(reason="a model of 30 MB is loaded twice")
@pytest.mark.parametrize(
    ("said", "text"),
    [
        ("yes", "yes"),
        ("tyrannosaurus", "tyrannosaurus"),
        ("tell me a joke", "tell me a joke"),
        ("my name is Lucy", "my name is lucy"),
        ("I'm eight", "im 8"),
        ("how old are you", "how old are you"),
    ],
)
def test_a_line_of_the_script_is_heard_as_it_is_written_there(heard, said, text):
    assert heard(said) == text
    assert heard(said) == text, "the same sound gives the same words"


def test_a_soft_voice_is_heard_too(heard):
    assert heard("how old are you", level=0.05) == "how old are you"


@pytest.mark.parametrize(
    "said",
    [
        "please pass me the salt and pepper",
        "the train leaves at half past nine",
        "interest rates are expected to rise",
    ],
)
def test_what_is_not_in_the_script_is_no_word(heard, said):
    assert heard(said) == ""


@pytest.mark.parametrize("level", [0.0, 0.001, 0.05])
def test_silence_and_noise_are_no_word(heard, level):
    noise = np.random.default_rng(1).normal(0.0, 1.0, 2 * RATE).astype(np.float32)
    assert heard.recognizer.hear(level * noise, RATE) == ""
    assert heard.recognizer.hear(noise[:0], RATE) == ""
    assert heard.recognizer.hear(noise[:40], RATE) == ""


def test_without_the_extra_there_is_a_line_that_says_how_to_get_it(monkeypatch):
    assert listening_problem() == ""
    monkeypatch.setitem(sys.modules, "pocketsphinx", None)
    assert "pip install pocketsphinx" in listening_problem()
    with pytest.raises(CharacterError, match="pip install pocketsphinx"):
        SpeechRecognizer(PHRASES)
