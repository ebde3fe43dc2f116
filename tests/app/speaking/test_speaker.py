"""What the character says in a session: live, recorded, and without a voice."""

import sys
from dataclasses import replace
from pathlib import Path

import pytest

from cubeling.app.running.frame_loop import FrameLoop
from cubeling.app.running.opening import open_session
from cubeling.app.running.runner import run
from cubeling.app.running.summary.summary import Summary
from cubeling.app.session import SessionOptions, messages
from cubeling.app.session.encoding import decode
from cubeling.app.speaking import opening, voices
from cubeling.characters import Character, CharacterCommand, CharacterError
from cubeling.characters.speech.voices import Voice, VoiceError
from tests.app import session_parts

BUZZ = """
import json, math, struct, sys
for line in sys.stdin.buffer:
    text = json.loads(line)["text"]
    out = sys.stdout.buffer
    count = 800 * len(text)
    events = [{"rate": 16000}]
    events += [{"phone": "a" if n % 2 else "m", "at": 800 * n} for n in range(len(text))]
    events += [{"word": 0, "length": len(text), "at": 0}, {"pcm": 2 * count}]
    out.write(b"".join(json.dumps(event).encode() + b"\\n" for event in events))
    wave = [round(9000 * math.sin(n / 16000 * 2 * math.pi * 150)) for n in range(count)]
    out.write(struct.pack(f"<{count}h", *wave) + json.dumps({"end": count}).encode() + b"\\n")
    out.flush()
"""


@pytest.fixture(scope="module")
def spoken(tmp_path_factory, short_session) -> Path:
    """A session in which a voice is installed that buzzes."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(voices, "espeak", lambda: Voice((sys.executable, "-S", "-c", BUZZ)))
        return recording_of(short_session, tmp_path_factory.mktemp("spoken"))


def recording_of(source: Path, tmp_path: Path) -> Path:
    path = tmp_path / "spoken.mcap"
    options = SessionOptions(
        scenario="companion", source=str(source), robot="none", pictures=False,
        language="en", record=path,
    )  # fmt: skip
    with open_session(options) as session:
        run(session)
    return path


def said_in(path: Path) -> list[str]:
    commands = [decode(CharacterCommand, d) for _, _, d in messages(path, "/character/command")]
    texts = [command.speech.utterance.text for command in commands if command.speech]
    return list(dict.fromkeys(texts))


@pytest.mark.slow(reason="a session is recorded and checked")
def test_a_session_with_speech_replays_byte_for_byte_without_a_voice(spoken, monkeypatch):
    assert said_in(spoken)
    assert [line.utterance.text for line in session_parts.lines(spoken).values()] == said_in(spoken)

    def gone():
        raise VoiceError("no voice")

    monkeypatch.setattr(voices, "espeak", gone)
    options = SessionOptions(scenario="companion", source=str(spoken))
    assert session_parts.check(spoken, options).identical


def test_a_recorded_line_keeps_its_sound(spoken):
    line = next(iter(session_parts.lines(spoken).values()))
    assert line.rate == 16000
    assert len(line.samples) == 800 * len(line.utterance.text)
    assert abs(line.samples).max() == pytest.approx(9000 / 2**15, rel=1e-3)


def test_without_a_voice_a_character_is_silent_unless_it_was_asked_to_speak(tmp_path, monkeypatch):
    def gone():
        raise VoiceError("no voice is installed", "sudo apt-get install -y espeak-ng")

    monkeypatch.setattr(voices, "espeak", gone)
    windowed = SessionOptions(scenario="companion", source="camera:0")
    speaker = opening.open_speaker(windowed, [Character.load("vleo")], waits=False)
    assert speaker.lines(0.0) == {}
    with pytest.raises(CharacterError, match="apt-get install"):
        opening.open_speaker(
            replace(windowed, language="en"), [Character.load("vleo")], waits=False
        )


@pytest.fixture
def rules(tmp_path):
    path = tmp_path / "rules.toml"
    path.write_text("[[rule]]\nwhen = 'lifted'\nsay = 'Hello!'\n")
    return str(path)


def test_what_a_file_of_rules_says_is_heard_in_a_film_too(rules, short_session):
    film = SessionOptions(scenario=rules, source=str(short_session), robot="none", pictures=False)
    with open_session(film) as session:
        assert session.speaker.language == "en"
    for silent in (replace(film, language="none"), replace(film, scenario="companion")):
        with open_session(silent) as session:
            assert not session.speaker.live


def test_a_film_of_rules_without_a_voice_says_why_it_is_silent(rules, monkeypatch):
    def gone():
        raise VoiceError("no voice is installed", "sudo apt-get install -y espeak-ng")

    monkeypatch.setattr(voices, "espeak", gone)
    film = SessionOptions(scenario=rules, source="camera:0", output=Path("film.mp4"))
    speaker = opening.open_speaker(film, [Character.load("human")], waits=True)
    assert speaker.lines(0.0) == {}
    assert "no voice is installed" in speaker.problem


def test_a_voice_that_always_dies_is_given_up_and_the_session_goes_on(
    tmp_path, short_session, monkeypatch
):
    dying = (sys.executable, "-S", "-c", "import sys; sys.stdin.readline()")
    monkeypatch.setattr(voices, "espeak", lambda: Voice(dying))
    assert said_in(recording_of(short_session, tmp_path)) == []


def test_a_line_that_begins_in_a_frame_that_is_left_out_begins_in_the_next(spoken):
    begin = min(session_parts.lines(spoken))
    options = SessionOptions(scenario="companion", source=str(spoken), robot="none", pictures=False)
    with open_session(options) as session:
        loop = FrameLoop(session, Summary("companion"))
        frames = iter(session.source)
        for frame in frames:
            if frame.timestamp == begin:
                loop.leave_out(frame)
                break
            assert loop.step(frame).line is None
        following, after = loop.step(next(frames)), loop.step(next(frames))
    assert following.command.speech is not None
    assert following.command.speech.start == following.frame.timestamp
    assert after.line is following.line is not None
    assert after.command.speech == following.command.speech
