"""A voice in a process of its own: its protocol, and what happens when the process fails."""

import itertools
import sys

import numpy as np
import pytest

from cubeling.characters.speech.speech import SILENCE
from cubeling.characters.speech.voices import Manner, Voice, VoiceError, espeak
from cubeling.characters.speech.voices.espeak import espeak_installed

needs_espeak = pytest.mark.skipif(not espeak_installed(), reason="eSpeak NG is not installed")


def program(*lines: str, timeout: float = 2.0) -> Voice:
    """Return a voice that runs these lines of Python for each text."""
    body = "".join(f"    {line}\n" for line in lines)
    source = f"import json, os, sys, time\nfor line in sys.stdin.buffer:\n{body}"
    source += "    sys.stdout.flush()\n"
    return Voice((sys.executable, "-S", "-u", "-c", source), timeout)


def event(text: str) -> str:
    return f"sys.stdout.buffer.write({text!r}.encode() + b'\\n')"


@pytest.fixture(scope="module")
def voice():
    with espeak() as made:
        yield made


@needs_espeak
@pytest.mark.parametrize(
    ("text", "language"),
    [
        ("Hello, Barcelona!", "en"),
        ("Bon dia, nens", "ca"),
        ("Schöne Züge 😀", "de"),
        ("你好", "cmn"),
    ],
)
def test_phones_fill_the_speech_without_gaps(voice, text, language):
    speech = voice.say(text, language)
    starts = [phone.start for phone in speech.phones]
    assert starts == [0.0, *(phone.end for phone in speech.phones[:-1])]
    assert speech.phones[-1].end == pytest.approx(speech.duration)
    assert sum(phone.symbol != SILENCE for phone in speech.phones) >= 4


@needs_espeak
def test_words_are_where_the_text_has_them(voice):
    text = "One fish, two fish."
    words = voice.say(text).words
    assert [word.text for word in words] == ["One", "fish", "two", "fish"]
    assert all(text[word.offset :].startswith(word.text) for word in words)
    assert all(a.end <= b.start for a, b in itertools.pairwise(words))


@needs_espeak
def test_the_sound_of_a_phone_is_where_the_voice_says(voice):
    speech = voice.say("Stop it. Now!")
    for phone in speech.phones:
        part = speech.samples[round(phone.start * speech.rate) : round(phone.end * speech.rate)]
        if phone.end - phone.start > 0.1:
            assert (np.abs(part).max() < 0.02) == (phone.symbol == SILENCE)


@needs_espeak
def test_a_fast_manner_is_shorter(voice):
    usual, fast = voice.say("Good morning"), voice.say("Good morning", manner=Manner(rate=1.5))
    assert 0.5 < fast.duration / usual.duration < 0.8


@needs_espeak
def test_an_unknown_language_is_one_line_and_the_voice_goes_on(voice):
    with pytest.raises(VoiceError, match="no voice speaks 'xx'"):
        voice.say("Hello", "xx")
    assert voice.say("Hello").duration > 0.2


@pytest.mark.parametrize("text", ["", "  \n", "word " * 5000])
def test_no_text_and_too_much_text_are_refused(text):
    with pytest.raises(VoiceError, match="text"):
        Voice(("no-such-program",)).say(text)


def test_a_voice_that_is_not_there_is_named():
    with pytest.raises(VoiceError, match="no-such-program"):
        Voice(("no-such-program",)).say("Hello")


def test_a_voice_that_dies_in_mid_word_costs_one_text():
    again = 'json.loads(line)["text"] == "Again"'
    voice = program(
        event('{"rate": 1000}'),
        event('{"pcm": 200}'),
        "sys.stdout.buffer.write(bytes(200))",
        "sys.stdout.flush()",
        f"{again} or os._exit(1)",
        event('{"end": 100}'),
    )
    with voice:
        with pytest.raises(VoiceError, match=r"stopped after 0\.1 s"):
            voice.say("Hello")
        assert voice.say("Again").duration == pytest.approx(0.1)


def test_a_voice_that_hangs_is_given_up():
    with (
        program(
            event('{"rate": 1000}'), "sys.stdout.flush()", "time.sleep(60)", timeout=0.5
        ) as voice,
        pytest.raises(VoiceError, match=r"has not answered in 0\.5 s"),
    ):
        voice.say("Hello")


@pytest.mark.parametrize(
    "lines",
    [
        [event("nonsense")],
        [event('{"pcm": -1}')],
        [event('{"pcm": 9000000000}')],
        [event('{"rate": 0}'), event('{"end": 0}')],
        [event('{"word": "x", "length": 1, "at": 0}')],
        [event("[1, 2]"), event('{"end": 0}')],
    ],
)
def test_nonsense_from_a_voice_is_one_line(lines):
    with program(*lines) as voice, pytest.raises(VoiceError):
        voice.say("Hello")


@needs_espeak
def test_a_text_without_a_word_is_one_line(voice):
    with pytest.raises(VoiceError, match=r"nothing to say in '\.\.\.'"):
        voice.say("...")
