"""What the further characters of a cast say: their voices, their turns, and their recording."""

import sys
from collections import Counter
from pathlib import Path

import pytest

from cubeling.app.pipeline.table.spoken_line import LEAD
from cubeling.app.running.opening import open_session
from cubeling.app.running.runner import run
from cubeling.app.session import SessionFile, SessionOptions, messages, session_info
from cubeling.app.session.encoding import decode
from cubeling.app.speaking import voices
from cubeling.app.speaking.cast_voices import OWN_VOICES, voices_of_cast
from cubeling.app.speaking.lines import WATCHING, ScenarioLines, bundled_lines, read_lines_for
from cubeling.characters import CharacterCommand
from cubeling.characters.speech import Manner
from cubeling.characters.speech.voices import Voice, VoiceError
from tests.app import session_parts
from tests.app.speaking.test_speaker import BUZZ

OTHERS = ("human", "vleo")


@pytest.fixture(scope="module")
def spoken(tmp_path_factory, short_session):
    """A session of three that all have lines, with a voice that buzzes."""
    folder = tmp_path_factory.mktemp("cast")
    lines = folder / "lines.toml"
    lines.write_text("[voice.en]\nidle = 'I'\n[others.en]\nidle = ['You', 'We']\n")
    path = folder / "cast.mcap"
    record(short_session, path, scenario="companion", lines=lines, others=OTHERS)
    return path


def record(source, path, **options):
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(voices, "espeak", lambda: Voice((sys.executable, "-S", "-c", BUZZ)))
        asked = SessionOptions(
            source=str(source), robot="none", pictures=False, language="en", record=path, **options
        )
        with open_session(asked) as session:
            run(session)


def speeches_in(path, name):
    topic = f"/cast/{name}/command" if name else "/character/command"
    return [decode(CharacterCommand, data) for _, _, data in messages(path, topic)]


def test_each_says_its_own_line_on_a_channel_of_its_own(spoken):
    with SessionFile(spoken) as session:
        said = session.lines
    words = {name: line.utterance.text for each in said.values() for name, line in each.items()}
    assert words[LEAD] == "I"
    assert set(words) > {LEAD}
    for name in set(words) - {LEAD}:
        assert words[name] in ("You", "We")
        (sound,) = messages(spoken, f"/cast/{name}/line")
        assert len(sound[2]) > 800 * 2 * len(words[name])


def test_one_speaks_at_a_time_and_its_lips_move(spoken):
    speaking: Counter[float] = Counter()
    for name in (LEAD, "human", "vleo_2"):
        for command in speeches_in(spoken, name):
            speaking[command.timestamp] += command.speaks
    assert max(speaking.values()) == 1


DIALOGUE = """
others = ["vleo"]
[[rule]]
when = "always"
say = "Hello"
[[rule]]
who = "vleo"
when = "heard human"
say = "Yes"
"""


@pytest.mark.slow(reason="a session is recorded and processed again")
def test_two_characters_talk_by_rules_and_do_so_again_in_a_replay(tmp_path, short_session):
    rules, path = tmp_path / "talk.toml", tmp_path / "talk.mcap"
    rules.write_text(DIALOGUE)
    record(short_session, path, scenario=str(rules))
    ask, answer = (
        next(each.speech for each in speeches_in(path, name) if each.speech)
        for name in (LEAD, "vleo")
    )
    assert (ask.utterance.text, answer.utterance.text) == ("Hello", "Yes")
    assert ask.end < answer.start < ask.end + 0.5
    assert session_parts.check(path, session_info(path).options).identical


@pytest.mark.full  # a session is processed again, as that of two who talk by rules
def test_a_session_in_which_several_speak_replays_byte_for_byte_without_a_voice(
    spoken, monkeypatch
):
    def gone():
        raise VoiceError("no voice")

    monkeypatch.setattr(voices, "espeak", gone)
    result = session_parts.check(spoken, session_info(spoken).options)
    assert result.identical
    assert result.counts["/cast/vleo_2/command"] > 10


def test_no_two_voices_are_the_same_and_a_name_keeps_its_own():
    names = ["vleo", "human_2", "vleo_2", "robot"]
    chosen = voices_of_cast(names)
    assert len({(each.speaker, each.pitch, each.rate) for each in chosen.values()}) == len(names)
    assert Manner() not in chosen.values(), "the lead has the usual one"
    assert voices_of_cast(["vleo"])["vleo"] == chosen["vleo"]
    assert len(OWN_VOICES) >= 4


def test_those_who_watch_say_what_is_bundled_unless_a_file_has_their_lines(tmp_path):
    path = tmp_path / "lines.toml"
    path.write_text("[voice.en]\nidle = 'I'\n")
    assert read_lines_for(path, WATCHING, "en") == bundled_lines(WATCHING, "en")
    assert bundled_lines(WATCHING, "xx") is None
    path.write_text("[voice.en]\nidle = 'I'\n[others.en]\nidle = 'You'\n")
    assert read_lines_for(path, WATCHING, "en") == ScenarioLines("en", {"idle": ("You",)})
    assert read_lines_for(path, "companion", "en") == ScenarioLines("en", {"idle": ("I",)})
    assert read_lines_for(path, WATCHING, "de") is None, "they are silent in it"


@pytest.mark.parametrize(
    ("others", "said"), [("idle = 3", "others.en.idle"), ("idle = ' '", "1 to 300 characters")]
)
def test_wrong_lines_of_the_others_are_refused_in_one_line(cubeling, others, said):
    Path("my.toml").write_text(f"[voice.en]\nidle = 'I'\n[others.en]\n{others}\n")
    code, _, err = cubeling("play", "follow", "--lines", "my.toml", "--language", "en")
    assert code == 2
    assert err.startswith("cubeling: my.toml: ")
    assert said in err
    assert err.count("\n") == 1
