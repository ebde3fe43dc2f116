"""Push to talk: what is heard is an input, and what is wrong is one line."""

import sys
import threading
from typing import cast

import numpy as np
import pytest

from cubeling.app.pipeline.scenario import Inputs
from cubeling.app.scenarios.talk import Talk
from cubeling.app.sound import NoSoundError
from cubeling.app.speaking.listener import MAX_LISTEN_S, NOTHING_HEARD, PushToTalk
from cubeling.app.speaking.microphone import MICROPHONE_HZ, SILENT_S
from cubeling.characters import speech
from cubeling.characters.speech import SpeechRecognizer

SCRIPT = Talk.script


class FakeMicrophone:
    """Hears a constant, of which the value says what was said."""

    opened = closed = 0

    def __init__(self, sound=0.5):
        type(self).opened += 1
        self._sound = sound

    def read(self):
        return np.full(0 if self._sound is None else 160, self._sound or 0.0, np.float32)

    def close(self):
        type(self).closed += 1


class Recognizer:
    """Hears "hello" in what is loud."""

    def hear(self, samples, rate):
        assert rate == MICROPHONE_HZ
        return "hello" if len(samples) and samples.max() > 0.1 else ""


class Clock:
    """A clock of which each look takes a while."""

    def __init__(self, step_s):
        self.now, self._step_s = 0.0, step_s

    def __call__(self):
        self.now += self._step_s
        return self.now


@pytest.fixture(autouse=True)
def recognizer(monkeypatch):
    FakeMicrophone.opened = FakeMicrophone.closed = 0
    monkeypatch.setattr(speech, "SpeechRecognizer", lambda *_: Recognizer())


def outcome_of(listener, *, end=True, language="en"):
    """Press the key, and once more; return what has come of it."""
    listener.begin(SCRIPT, language)
    if end:
        listener.end()
    listener._thread.join(10)
    assert not listener.listening
    told = Inputs()
    while (heard := listener.inputs()) != Inputs():
        told = Inputs(typed=told.typed or heard.typed, hush=told.hush or heard.hush)
    notice = listener.notice()
    listener.close()
    assert FakeMicrophone.opened == FakeMicrophone.closed
    return told, notice


def test_what_is_heard_is_an_input_and_interrupts():
    assert outcome_of(PushToTalk(FakeMicrophone)) == (Inputs(typed="hello", hush=True), "")


def test_what_is_not_understood_is_said_so():
    told, notice = outcome_of(PushToTalk(lambda: FakeMicrophone(0.0)))
    assert (told.typed, notice) == ("", NOTHING_HEARD)


def test_a_key_that_is_forgotten_ends_by_itself():
    told, _ = outcome_of(PushToTalk(FakeMicrophone, Clock(MAX_LISTEN_S / 3)), end=False)
    assert told.typed == "hello"


def test_a_microphone_that_sends_nothing_is_lost():
    _, notice = outcome_of(PushToTalk(lambda: FakeMicrophone(None), Clock(SILENT_S / 2)), end=False)
    assert notice == "The microphone was lost; typing goes on"


def test_without_a_microphone_typing_goes_on():
    def none():
        raise NoSoundError("no microphone can be opened: none", "buy one")

    told, notice = outcome_of(PushToTalk(none))
    assert told == Inputs()
    assert notice == "no microphone can be opened: none: buy one; typing goes on"


def test_another_language_is_refused_in_a_line():
    told, notice = outcome_of(PushToTalk(FakeMicrophone), language="es")
    assert told == Inputs()
    assert notice == "speech is understood in English only, not in 'es': type instead"


def test_without_the_extra_typing_goes_on(monkeypatch):
    monkeypatch.setitem(sys.modules, "pocketsphinx", None)
    told, notice = outcome_of(PushToTalk(FakeMicrophone))
    assert told == Inputs()
    assert notice.endswith("pip install pocketsphinx; typing goes on")


def test_who_speaks_again_before_the_words_are_known_is_told():
    working = threading.Event()

    class Slow(Recognizer):
        def hear(self, samples, rate):
            working.wait(10)
            return "hello"

    listener = PushToTalk(FakeMicrophone)
    listener._known = SCRIPT, "en", cast(SpeechRecognizer, Slow())
    listener.begin(SCRIPT, "en")
    listener.end()
    listener.begin(SCRIPT, "en")
    assert "One moment" in listener.notice()
    working.set()
    listener.close()
    assert listener.inputs().hush
    assert listener.inputs().typed == "hello"
