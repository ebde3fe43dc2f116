"""Blocks of BML in plays, and as plays: with the cube, in a recording, and over to the next cue."""

from dataclasses import replace

import numpy as np
import pytest

from cubeling.app.pipeline.cast.cast import Cast
from cubeling.app.pipeline.cast.member import CastMember
from cubeling.app.pipeline.checkpoint import Checkpoint
from cubeling.app.pipeline.scenario import OVER_EVENT, Inputs, ScenarioSettings
from cubeling.app.pipeline.step import ReplayInputs, Step
from cubeling.app.pipeline.table.attention import Attention
from cubeling.app.pipeline.table.situation import SeenCube
from cubeling.app.running.opening import open_session
from cubeling.app.running.replay_check import check_session
from cubeling.app.running.runner import run
from cubeling.app.scenarios import find_scenario
from cubeling.app.session import SessionFile, SessionOptions
from cubeling.app.show.scenario import show_scenario
from cubeling.app.speaking.line_chooser import LineRequest
from cubeling.app.speaking.speaker import soundless_line
from cubeling.bad_input import BadInputError
from cubeling.characters.speech import DEFAULT_PROFILE, Manner
from cubeling.tracking import CubeState
from tests.app.conftest import Hand
from tests.app.show.test_show import CUBE, FRAME, show_of
from tests.bundled_characters import bundled_character

ANN = '<character name="ann" body="human"/>'
GREETING = (
    '<bml who="ann" id="greets">\n<head id="h" lexeme="NOD" start="0.5" end="1.5"/>\n'
    '<speech id="s" start="1"><text>Good <sync id="m"/>morning</text></speech>\n'
    '<gaze id="g" target="cube" start="s:m" end="s:end"/>\n</bml>'
)


class Stage:
    """A cast of one, whose voice answers after some frames."""

    def __init__(self, path, late=3):
        self.hand, self.late = Hand(), late
        scenario = show_scenario(path)(CUBE, ScenarioSettings())
        member = CastMember("a", bundled_character("human"), scenario, Attention("camera", 0.06))
        self.cast, self.asked, self.due = Cast([member]), [], {}

    def frame(self, **asked):
        controls = self.hand.frame()
        away = np.eye(4)
        away[2, 3] = 0.5
        seen = [
            SeenCube(
                CubeState(
                    True, away, np.zeros(6), np.eye(6), "markers", (), 0.1, controls.timestamp
                ),
                controls,
            )
        ]
        inputs = Inputs(line=self.due.pop(self.hand.frames, None), **asked)
        told = self.cast.hear(inputs, controls.timestamp)
        decisions = self.cast.decide(seen, told)
        (done,) = self.cast.perform(seen, decisions, told, (), None, ReplayInputs())
        if done.outcome.reply is not None:
            self.asked.append(done.outcome.reply.text)
            request = LineRequest(done.outcome.reply.text, "en", Manner())
            self.due[self.hand.frames + self.late] = soundless_line(request, DEFAULT_PROFILE)
        return done

    def play(self, seconds):
        return [self.frame() for _ in range(round(seconds / FRAME))]


def when(frames, true):
    return [each.posed.timestamp for each in frames if true(each)]


def test_a_block_is_performed_in_time_and_its_end_is_awaited(tmp_path):
    path = show_of(
        tmp_path, f'{GREETING}<wait for="greets" before="0.2"/><do who="ann">wave</do>', ANN
    )
    stage = Stage(path)
    frames = stage.play(4.0)
    assert stage.asked == ["Good morning"]
    nods = when(frames, lambda each: each.command.behaviour and each.command.behaviour.heads)
    assert nods[0] == pytest.approx(0.5, abs=3 * FRAME)
    says = when(frames, lambda each: each.command.speech is not None)
    assert says[0] == pytest.approx(1.0, abs=3 * FRAME)
    line = next(each.line for each in frames if each.line is not None)
    gazes = when(frames, lambda each: each.command.behaviour and each.command.behaviour.gazes)
    assert gazes[0] == pytest.approx(says[0] + line.utterance.words[1].start, abs=3 * FRAME)
    waves = when(frames, lambda each: each.outcome.icon == "wave")
    assert waves[0] == pytest.approx(says[0] + line.utterance.duration - 0.2, abs=3 * FRAME)


def test_a_block_that_is_cut_off_falls_silent(tmp_path):
    path = show_of(tmp_path, f'{GREETING}<wait seconds="1.2"/><stop what="greets"/>', ANN)
    frames = Stage(path).play(2.5)
    says = when(frames, lambda each: each.command.speech is not None)
    assert says[-1] < 1.2 + 3 * FRAME
    assert OVER_EVENT in frames[-1].outcome.events


def test_a_dialogue_takes_over_from_a_block(tmp_path):
    (tmp_path / "my.xml").write_text(
        '<dialogue><unit name="u"><state name="q"><transition>'
        '<condition type="input_match">* you *</condition><action type="say">Me.</action>'
        "</transition></state></unit></dialogue>"
    )
    stage = Stage(show_of(tmp_path, f'{GREETING}<talk script="my.xml"/>', ANN))
    stage.play(0.8)
    stage.frame(typed="who are you?")
    frames = stage.play(1.5)
    assert stage.asked[-1] == "Me."
    assert not any(each.command.behaviour for each in frames)
    assert any(each.line is not None and each.line.utterance.text == "Me." for each in frames)


def test_a_checkpoint_within_a_block_goes_on_as_it_did(tmp_path):
    stage = Stage(show_of(tmp_path, GREETING, ANN))
    stage.play(0.7)
    copy = Checkpoint({"stage": stage}).content()["stage"]
    for one, other in zip(stage.play(1.0), copy.play(1.0), strict=True):
        assert (one.posed.pose.rotations == other.posed.pose.rotations).all()
        assert (one.line is None) == (other.line is None)


def test_a_file_of_bml_is_a_scenario_that_a_replay_repeats(tmp_path, short_session):
    path = tmp_path / "nod.bml"
    path.write_text(
        '<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="b"><head id="h" lexeme="NOD"/>'
        '<speech id="s" start="0.1"><text>Hello</text></speech></bml>'
    )
    assert find_scenario(str(path)).character == "human"
    options = SessionOptions(
        scenario=str(path),
        source=str(short_session),
        record=tmp_path / "s.mcap",
        pictures=False,
        robot="none",
        language="none",
    )
    steps: list[Step] = []
    with open_session(options) as session:
        run(session, steps.append)
    assert any(each.line is not None for each in steps)
    with SessionFile(tmp_path / "s.mcap") as recorded:
        again = replace(options, source=str(recorded.path), record=None, language=None)
        assert check_session(recorded, again).identical


def test_a_block_that_cannot_be_read_is_named_by_line(tmp_path):
    path = show_of(tmp_path, '<bml who="ann"/>', ANN)
    with pytest.raises(BadInputError, match=r"my\.show:2: BML, line 1: a block without an id"):
        find_scenario(str(path))
    path = show_of(tmp_path, '<bml who="ann" file="gone.bml"/>', ANN)
    with pytest.raises(BadInputError, match=r"my\.show:2: .*gone\.bml"):
        find_scenario(str(path))
