"""No reply ends the thread of the voice: what cannot be said as it is written is said plainly."""

import sys
from types import SimpleNamespace

import numpy as np
import pytest

from cubeling.affect import Emotion
from cubeling.app.pipeline.scenario import Outcome, Reply
from cubeling.app.speaking.speaker import MAX_FAILURES, LiveSpeaker
from cubeling.characters.speech import DEFAULT_PROFILE
from cubeling.characters.speech.voices import Voice, espeak
from cubeling.characters.speech.voices.espeak import espeak_installed
from tests.app.speaking.test_speaker import BUZZ

CALM = Emotion(0.0, 0.0)
PIECES = (
    '<begin_gesture id="a" anim="nod"/>', '<begin_gesture id="b" anim="wave"/>',
    '<end_gesture id="a"/>', '<end_gesture id="b"/>', "<end_gesture/>", '<begin_gesture id="a"/>',
    "<begin_gesture id='a' anim=''>", "<begin_gesture", "<topic/>", "<", ">", "<<>>", '"', "&amp;",
    "hello", "T. rex", "¡Hola!", "I'm", "…", "!?", "🦖", "\n\n", "\t", "\0", "\ud800", "\u202e",
    "e\u0301", "漢字", "١٢", "1e309", "-", "word " * 40, "x" * 300,
)  # fmt: skip


def random_reply(rng: np.random.Generator) -> str:
    """Return a text of pieces that seldom fit together."""
    return " "[rng.integers(2) :].join(
        PIECES[k] for k in rng.integers(len(PIECES), size=rng.integers(8))
    )


class Asked:
    """A speaker, and steps that ask it for replies."""

    def __init__(self, voice):
        self.speaker = LiveSpeaker(voice, lambda *_: None, ("en",), DEFAULT_PROFILE, waits=True)

    def answer(self, text):
        """Return the line that is said for a reply; None for none."""
        command = SimpleNamespace(timestamp=0.0)
        outcome = Outcome(command, SimpleNamespace(), "", "", reply=Reply(text, "en"))  # type: ignore[arg-type]
        seen = SimpleNamespace(
            scenario="talk", outcome=outcome, emotion=SimpleNamespace(emotion=CALM)
        )
        frame = SimpleNamespace(timestamp=0.0)
        controls = SimpleNamespace(gestures=())
        step = SimpleNamespace(cast=(seen,), frame=frame, controls=controls, players=())
        self.speaker.hear(step)  # type: ignore[arg-type]
        return next(iter(self.speaker.lines(0.0).values()), None)


@pytest.fixture
def asked(request):
    found = Asked(request.param() if hasattr(request, "param") else None)
    yield found
    found.speaker.close()


def buzzing():
    return Voice((sys.executable, "-S", "-c", BUZZ))


BROKEN = 'Hi <begin_gesture id="a" anim="nod"/>there'


@pytest.mark.parametrize("asked", [lambda: None, buzzing], indirect=True)
def test_a_reply_with_broken_tags_is_said_without_them_and_told_once(asked):
    for _ in range(2):
        line = asked.answer(BROKEN)
        assert (line.utterance.text, line.utterance.gestures) == ("Hi there", ())
    assert asked.speaker.notice() == "“Hi there”: gesture 'a' never ends; add <end_gesture id=…/>"
    assert asked.speaker.notice() == ""
    assert asked.speaker.problem == ""


@pytest.mark.parametrize("asked", [buzzing], indirect=True)
def test_texts_that_cannot_be_said_do_not_silence_the_voice(asked):
    for _ in range(MAX_FAILURES + 1):
        assert not asked.answer("").samples.any()
    assert "no text to say" in asked.speaker.notice()
    assert asked.answer("hello").samples.any()


@pytest.mark.full
def test_no_reply_of_ten_thousand_ends_the_voice(asked):
    rng = np.random.default_rng(1)
    for number in range(10_000):
        text = random_reply(rng)
        line = asked.answer(text)
        assert line is not None, (number, text)
    assert asked.speaker._thread.is_alive()


@pytest.mark.skipif(not espeak_installed(), reason="eSpeak NG is not installed")
def test_half_a_character_does_not_stop_the_voice():
    with espeak() as voice:
        assert voice.say("hi \ud800 you").duration > 0.3
