"""`cubeling behave`: files of BML as videos and motions."""

import sys
from xml.etree import ElementTree

import av
import numpy as np
import pytest

from cubeling.app.commands.make.behave import behave
from cubeling.app.errors import AppError
from cubeling.app.speaking import voices
from cubeling.characters import CharacterError, load_motion
from cubeling.characters.speech.voices import Voice, VoiceError
from tests.app.behaving.players import block
from tests.app.speaking.test_speaker import BUZZ

BLOCK = """<speech id="s" start="0.5"><text>Hi</text></speech>
    <gaze target="door" start="0"/><gesture lexeme="MOONWALK"/>"""


@pytest.fixture
def buzz(monkeypatch):
    """Let a voice be installed that buzzes."""
    monkeypatch.setattr(voices, "espeak", lambda: Voice((sys.executable, "-S", "-c", BUZZ)))


@pytest.fixture
def document(tmp_path):
    path = tmp_path / "a.bml"
    path.write_text(block(BLOCK), "utf-8")
    return path


@pytest.mark.slow(reason="a video is drawn")
def test_a_file_becomes_a_video_with_sound_and_its_feedback_a_file(
    buzz, document, tmp_path, capsys
):
    out, feedback = tmp_path / "a.mp4", tmp_path / "f.xml"
    behave([document], out, feedback=feedback, target=["door=1,0.2,0.3"], size="160x120", rate=10.0)
    with av.open(str(out)) as file:
        sound = np.concatenate([f.to_ndarray() for f in file.decode(audio=0)], axis=1)
    begin = np.flatnonzero(np.abs(sound).max(axis=0) > 0.02)[0] / 48_000
    assert begin == pytest.approx(0.5, abs=0.03)
    kinds = [each.tag.partition("}")[2] for each in ElementTree.parse(feedback).getroot()]
    assert kinds.count("blockProgress") == 2
    assert "warningFeedback" in kinds
    assert "MOONWALK" in capsys.readouterr().out


def test_without_a_voice_the_rest_is_performed_with_one_warning(
    document, tmp_path, monkeypatch, capsys
):
    def gone():
        raise VoiceError("no voice")

    monkeypatch.setattr(voices, "espeak", gone)
    out = tmp_path / "a.bvh"
    behave([document], out, target=["door=1,0.2,0.3"], rate=20.0)
    assert load_motion(out, scale=1.0).clip.rate == pytest.approx(20)
    assert capsys.readouterr().out.count("no voice") == 1


def test_a_motion_can_be_written_in_the_parameters_of_mpeg_4(buzz, document, tmp_path):
    out = tmp_path / "a.bap"
    behave([document], out, target=["door=1,0.2,0.3"], rate=20.0)
    assert load_motion(out).clip.rate == pytest.approx(20)


@pytest.mark.parametrize(
    ("text", "why"), [("<bml", "not XML"), ("<bml/>", "without an id"), ("<html/>", "is no <bml>")]
)
def test_a_file_that_is_no_block_is_one_line_that_names_it(tmp_path, text, why):
    path = tmp_path / "bad.bml"
    path.write_text(text, "utf-8")
    with pytest.raises(CharacterError, match=why) as caught:
        behave([path], tmp_path / "a.bvh")
    assert "bad.bml" in str(caught.value)


@pytest.mark.parametrize("target", ["door", "door=1,2", "=1,2,3", "door=a,b,c"])
def test_a_target_that_is_none_is_one_line(target, document):
    with pytest.raises(AppError, match="NAME=x,y,z"):
        behave([document], target=[target])


def test_nothing_to_perform_is_one_line():
    with pytest.raises(AppError, match="name a file of BML or FML"):
        behave([])


def test_an_emotion_that_there_is_not_is_one_line(document):
    with pytest.raises(AppError, match="no emotion is called"):
        behave([document], emotion="sqush")


@pytest.mark.parametrize(
    ("serve", "token", "why"),
    [(None, "open-sesame", "add --serve PORT"), (0, "short", "8 to 128 letters")],
)
def test_a_token_is_for_a_server_and_not_too_short(document, serve, token, why):
    with pytest.raises(AppError, match=why):
        behave([document], serve=serve, token=token, window=False)
