"""Moods of a session: read, and felt again as they were."""

import dataclasses
import itertools
import json

import numpy as np
import pytest

from cubeling.affect import Personality
from cubeling.app.errors import AppError
from cubeling.app.pipeline.playground import Playground
from cubeling.app.running.kept_lens import intrinsics_for
from cubeling.app.session import START_OVER_EVENT, Recorder
from cubeling.app.workshop.moods import read_history, read_robot_traces, replay_with, robot_traces
from cubeling.characters import LocomotionIntent
from cubeling.robot.protocol import messages as m
from cubeling.robot.protocol.schema import pack
from cubeling.robot.protocol.wire import encode_frame
from cubeling.tracking import open_source
from tests.app.workshop.moods.talking import SAID, state

FRAME = 1 / 30


def test_the_thesis_personality_feels_a_recorded_session_again_bit_for_bit(history):
    again = replay_with(history, Personality.load("thesis"))
    np.testing.assert_array_equal(again.emotion, history.recorded.emotion)
    assert again.labels == history.recorded.labels
    assert {"happy", "angry"} <= set(again.labels)


def test_other_personalities_feel_the_same_session_otherwise(history):
    felt = [replay_with(history, Personality.load(name)) for name in ("thesis", "grumpy", "lively")]
    for one, other in itertools.combinations(felt, 2):
        assert np.abs(one.emotion - other.emotion).max() > 0.3


def test_out_of_sight_nothing_is_done_that_could_be_felt(history):
    hidden = tuple(dataclasses.replace(each, visible=False) for each in history.commands)
    alone = dataclasses.replace(history, commands=hidden)
    assert set(replay_with(alone, Personality.load("thesis")).labels) == {"neutral"}
    assert set(alone.actions) == {""}


def test_who_starts_over_feels_anew(tmp_path, bundled_session):
    path = tmp_path / "over.mcap"
    about = {"scenario": "companion", "cube": "companion"}
    with open_source(str(bundled_session)) as source, Recorder(path, about) as recorder:
        playground = Playground("companion", intrinsics_for(source.intrinsics, source.size))
        frames = list(itertools.islice(source, 8))
        recorder.event(START_OVER_EVENT, frames[5].timestamp)
        for frame in frames:
            recorder.write(playground.step(frame))
    lively = Personality.load("lively")
    history = read_history(path)
    assert history.start_over_times == {frames[5].timestamp}
    excited = Personality("w", temperament=lively.temperament, movement=2.0, arousal_half_life=0.1)
    commands = tuple(
        dataclasses.replace(
            each, visible=True, locomotion=LocomotionIntent(5.0 if index < 5 else 0.0)
        )
        for index, each in enumerate(history.commands)
    )
    felt = replay_with(dataclasses.replace(history, commands=commands), excited)
    assert felt.emotion[4, 1] > 0.3
    assert felt.emotion[5, 1] == lively.temperament.arousal


def test_asked_acknowledged_and_observed_are_told_apart(talking_session):
    wire = read_robot_traces(talking_session)
    assert wire
    np.testing.assert_allclose(wire.delays, [0.05])
    times = np.array([0.0, 0.03, 0.10, 0.17, 0.22, 0.28, 0.31])
    acknowledged, _ = wire.acknowledged.at(times)
    nothing = [np.nan, np.nan]
    np.testing.assert_allclose(
        acknowledged, [nothing, nothing, *[[0.5, 0.25]] * 4, nothing], atol=1e-4
    )
    observed, moods = wire.observed.at(times)
    np.testing.assert_allclose(
        observed, [*[nothing] * 3, [0.1, 0.05], *[[0.4, 0.2]] * 3], atol=1e-4
    )
    assert moods == ["", "", "", "", "merry", "merry", "merry"]


def test_a_robot_that_was_away_still_has_what_it_had_taken(tmp_path, talking_session):
    path = tmp_path / "away.mcap"
    said = [*SAID[:5], (0.2, "rx", m.Welcome(2, 1, 1, 0, 0, 0, 2, "dino", "test"))]
    said += [(0.25, "tx", m.Stop(2)), (0.3, "rx", m.Ack(2, m.RESULT_TAKEN))]
    with open_source(str(talking_session)) as source, Recorder(path, {"scenario": "x"}) as recorder:
        playground = Playground("companion", intrinsics_for(source.intrinsics, source.size))
        recorder.write(playground.step(next(iter(source))))
        for time, direction, content in said:
            recorder.wire(direction, encode_frame(pack(content, 9)), time)
    acknowledged, _ = read_robot_traces(path).acknowledged.at(np.array([0.22, 0.4]))
    np.testing.assert_allclose(acknowledged, [[0.5, 0.25], [np.nan, np.nan]], atol=1e-4)


def test_what_a_robot_was_asked_took_and_refused_is_told_once(tmp_path, talking_session):
    path = tmp_path / "asked.mcap"
    said = [
        *SAID[:7],
        (0.2, "rx", m.Name(m.ITEM_MOTION, 4, "wave")),
        (0.3, "tx", m.Play(2, m.ITEM_MOTION, 4)),
        (0.32, "tx", m.Play(2, m.ITEM_MOTION, 4)),  # repeated, as no answer came
        (0.33, "rx", m.Ack(2, m.RESULT_TAKEN)),
        (0.34, "rx", m.Ack(2, m.RESULT_TAKEN)),
        (0.4, "tx", m.Play(3, m.ITEM_SOUND, 1)),
        (0.41, "rx", m.Ack(3, m.RESULT_BUSY)),
    ]
    with open_source(str(talking_session)) as source, Recorder(path, {"scenario": "x"}) as recorder:
        playground = Playground("companion", intrinsics_for(source.intrinsics, source.size))
        recorder.write(playground.step(next(iter(source))))
        for time, direction, content in said:
            recorder.wire(direction, encode_frame(pack(content, 9)), time)
    told = [(e.what, e.name, e.number) for e in read_robot_traces(path).events]
    assert told == [
        ("commanded", "", 1),
        ("acknowledged", "", 1),
        ("observed", "", None),
        ("asked", "wave", 2),
        ("taken", "wave", 2),
        ("asked", "1", 3),
        ("refused", "1", 3),
    ]
    assert read_robot_traces(path).events[-1].reason.startswith("it is busy")


def test_a_robot_that_is_silent_shows_nothing_that_is_known(tmp_path, talking_session):
    path = tmp_path / "silent.mcap"
    said = [*SAID[:7], (0.9, "rx", state(0.0, 0.0))]
    with open_source(str(talking_session)) as source, Recorder(path, {"scenario": "x"}) as recorder:
        playground = Playground("companion", intrinsics_for(source.intrinsics, source.size))
        recorder.write(playground.step(next(iter(source))))
        for time, direction, content in said:
            recorder.wire(direction, encode_frame(pack(content, 9)), time)
    wire = read_robot_traces(path)
    times = np.array([0.6, 0.7, 0.95])
    assert np.isnan(wire.acknowledged.at(times)[0][:, 0]).tolist() == [False, True, True]
    assert np.isnan(wire.observed.at(times)[0][:, 0]).tolist() == [False, True, False]


def test_what_a_robot_showed_is_told_at_the_times_of_its_own_clock(monkeypatch, short_session):
    """STATEs that arrive up to 80 ms late, from a clock that is 200 ppm fast."""
    random = np.random.default_rng(1)
    welcome = m.Welcome(3, 0, 1, 0, 0, 0, 2, "dino", "test")
    made: list[float] = []
    lines: list[tuple[float, str, object]] = [(0.0, "rx", welcome)]
    for count in range(1, 400):
        sent = 0.05 * count
        made.append(sent + 0.001 + random.exponential(0.001))
        late = random.choice([0.0, 0.01, 0.08], p=[0.3, 0.6, 0.1])
        arrives = max(made[-1] + 0.001 + late, lines[-1][0])  # none overtakes another
        own = int(1000 * made[-1] * 1.0002) + 77
        beat = dataclasses.replace(state(0.1, 0.1), beat=count, time=own)
        lines += [(sent, "tx", m.Beat(count)), (arrives, "rx", beat)]
    recorded = []
    for time, direction, content in sorted(lines, key=lambda line: line[0]):
        line = {"direction": direction, "hex": encode_frame(pack(content, 9)).hex()}
        recorded.append(("/robot/wire", time, json.dumps(line).encode()))
    monkeypatch.setattr(robot_traces, "messages", lambda *_: iter(recorded))
    told = read_robot_traces(short_session).observed.times
    errors = np.abs(told - made)
    assert (np.diff(told) >= 0).all()
    assert errors[20:].max() < 0.006  # once a STATE has come without delay
    assert np.median(errors[200:]) < 0.002


@pytest.mark.parametrize("line", [b"{", b"{}", b"[]", b'{"direction": "tx", "hex": "0g"}'])
def test_a_wire_that_no_recorder_wrote_is_refused_in_one_line(monkeypatch, short_session, line):
    monkeypatch.setattr(robot_traces, "messages", lambda *_: iter([("/robot/wire", 0.0, line)]))
    with pytest.raises(AppError, match=r"cannot read the session .* /robot/wire") as refusal:
        read_robot_traces(short_session)
    assert "\n" not in str(refusal.value)


def test_a_session_without_a_robot_has_nothing_to_acknowledge(short_session):
    wire = read_robot_traces(short_session)
    assert not wire
    emotion, words = wire.acknowledged.at(np.array([1.0]))
    assert np.isnan(emotion).all()
    assert words == [""]
