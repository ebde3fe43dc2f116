"""Recordings on a slow computer: in a window frames are not drawn, but all of them are decided."""

import itertools
import math
from dataclasses import replace

import pytest

from cubeling.app.pipeline.cast.cast import Cast
from cubeling.app.pipeline.scenario import Inputs
from cubeling.app.running.clock import Pace
from cubeling.app.running.opening import open_session
from cubeling.app.running.runner import run
from cubeling.app.session import SessionOptions
from cubeling.app.session.encoding import encode
from cubeling.app.ui.screen import NullScreen
from tests.app.conftest import SHORT_FRAMES

STARTED_OVER = frozenset({round(1 / 30, 9), round(4 / 30, 9)})


class VirtualTime:
    """A clock that only `sleep` and work advance."""

    def __init__(self):
        self.now = 1000.0

    def __call__(self):
        return self.now

    def sleep(self, seconds):
        self.now += seconds


def play(pace, time, work, count=300, decoding=0.001):
    """Play ten seconds at 30 frames/s; return (timestamp, when it was shown) of the shown ones."""
    shown, start = [], time()
    for index in range(count):
        time.sleep(decoding)
        if pace.wait(5.0 + index / 30):
            shown.append((index / 30, time() - start))
            time.sleep(work)
    return shown


@pytest.mark.parametrize("work", [0.001, 0.03, 0.1, 0.4, 1.5])
def test_a_recording_keeps_its_pace_however_long_a_picture_takes(work):
    time = VirtualTime()
    shown = play(Pace(1 / 30, time, time.sleep), time, work)
    for stamp, at in shown:
        assert stamp - 1e-6 <= at < stamp + 2 / 30 + 0.02
    assert len(shown) == pytest.approx(min(300, 10 / work), rel=0.35)


def test_a_fast_computer_leaves_no_frame_out():
    time = VirtualTime()
    assert len(play(Pace(1 / 30, time, time.sleep), time, work=0.02)) == 300


def test_on_a_computer_too_slow_to_decide_a_recording_plays_slower_with_pictures():
    time = VirtualTime()
    shown = play(Pace(1 / 30, time, time.sleep), time, work=0.2, decoding=0.06)
    gaps = [b - a for (_, a), (_, b) in itertools.pairwise(shown)]
    assert max(gaps) < 0.2 + 0.5 + 3 * 0.06
    left_out = [round(30 * (b - a)) - 1 for (a, _), (b, _) in itertools.pairwise(shown)]
    assert max(left_out) <= 0.5 / 0.06 + 1


def test_without_a_limit_every_frame_is_taken():
    time = VirtualTime()
    assert len(play(Pace(math.inf, time, time.sleep), time, work=0.1)) == 300


class SlowScreen(NullScreen):
    """Takes a tenth of a second for a picture, on virtual time; keeps what it showed."""

    def __init__(self, time):
        self.steps = []
        self._time = time

    def show(self, step, robot):
        self.steps.append(step)
        self._time.sleep(0.1)
        return super().show(step, robot)


def recorded_inputs(timestamp):
    return Inputs(clear=timestamp in STARTED_OVER)


@pytest.fixture
def play_slowly(short_session):
    """Run a session on a slow computer; return its steps and its summary."""

    def run_session(**settings):
        time = VirtualTime()
        screen = SlowScreen(time)
        options = SessionOptions(
            scenario="companion", source=str(short_session), robot="none", **settings
        )
        with open_session(options, screen=screen) as session:
            pace = session.pace and Pace(session.pace.max_late, time, time.sleep)
            played = replace(session, pace=pace)
            with pytest.MonkeyPatch.context() as patch:
                patch.setattr(played, "recorded_inputs", recorded_inputs)
                summary = run(played)
        return screen.steps, summary

    return run_session


@pytest.mark.slow(reason="a session is played twice")
def test_in_a_window_late_frames_are_decided_and_not_drawn(play_slowly):
    steps, summary = play_slowly()
    assert len(steps) == pytest.approx(SHORT_FRAMES / 3, abs=2)
    assert summary.left_out == SHORT_FRAMES - len(steps)
    assert summary.frames == SHORT_FRAMES
    assert len(summary.frame_seconds.values) == len(steps)
    assert steps[-1].frame.timestamp > SHORT_FRAMES / 30 - 0.2
    every, _ = play_slowly(pictures=False)
    decided = {step.frame.index: step for step in every}
    for step in steps:
        told, expected = (
            [encode(message) for message in (each.state, each.command, each.posed)]
            for each in (step, decided[step.frame.index])
        )
        assert told == expected


@pytest.mark.parametrize(
    "settings", [{"pictures": False}, {"output": "x.mp4"}, {"record": "x.mcap"}]
)
def test_what_is_written_or_checked_has_every_frame(play_slowly, settings, tmp_path):
    settings = {
        key: tmp_path / value if isinstance(value, str) else value
        for key, value in settings.items()
    }
    steps, summary = play_slowly(**settings)
    assert (len(steps), summary.left_out) == (SHORT_FRAMES, 0)


def test_a_replay_from_a_later_stage_keeps_messages_and_frames_together(play_slowly, short_session):
    steps, _ = play_slowly(stage="controls")
    assert len(steps) < SHORT_FRAMES / 2
    for step in steps:
        assert step.controls.timestamp == step.frame.timestamp


def test_a_player_who_started_over_in_a_frame_that_is_not_drawn_did_so_in_it(
    play_slowly, monkeypatch
):
    cleared = []
    decide = Cast.decide

    def note(self, seen, told, view):
        if told[0].clear:
            cleared.append(seen[0].controls.timestamp)
        return decide(self, seen, told, view)

    monkeypatch.setattr(Cast, "decide", note)
    play_slowly()
    assert cleared == sorted(STARTED_OVER)
