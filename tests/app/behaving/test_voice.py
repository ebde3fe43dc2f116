"""What a voice says for blocks: at once, on a thread, or not at all."""

import threading
from contextlib import closing

import pytest

from cubeling.app.behaving.opening import open_lines
from cubeling.app.behaving.voice import PatientSource, ThreadedSource
from cubeling.app.speaking import voices
from cubeling.characters.speech.voices import VoiceError
from tests.app.behaving.players import speech_of

WAIT_S = 20.0


def failing(_text, _language):
    raise VoiceError("the voice has lost its breath")


def test_no_frame_waits_for_a_voice_on_a_thread():
    asked, answered = threading.Event(), threading.Event()

    def slow(text, language):
        asked.set()
        answered.wait(WAIT_S)
        return speech_of(text, language)

    with closing(ThreadedSource(slow, "en")) as lines:
        assert lines.line("One two", "") is None
        assert asked.wait(WAIT_S)
        assert lines.line("One two", "") is None
        answered.set()
        lines.close()
        line = lines.line("One two", "")
    assert line is not None
    assert line.utterance.duration == 1.0
    assert line.utterance.language == "en"


@pytest.mark.parametrize("source", [PatientSource, ThreadedSource])
def test_a_voice_that_fails_is_a_problem_and_no_line(source):
    lines = source(failing, "en")
    lines.line("One", "")
    lines.close()
    assert lines.line("One", "") is None
    assert lines.problem == "the voice has lost its breath"


def test_a_text_is_spoken_once():
    texts = []

    def counted(text, language):
        texts.append((text, language))
        return speech_of(text, language)

    lines = PatientSource(counted, "en")
    assert lines.line("One", "") is lines.line("One", "en")
    lines.line("One", "ca")
    assert texts == [("One", "en"), ("One", "ca")]


def test_without_a_voice_nothing_is_said_unless_one_was_chosen(monkeypatch):
    def gone():
        raise VoiceError("no voice")

    monkeypatch.setattr(voices, "espeak", gone)
    lines = open_lines(None, "en")
    assert lines.line("One", "") is None
    assert lines.problem == "no voice"
