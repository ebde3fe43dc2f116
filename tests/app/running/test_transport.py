"""Pauses, seeks, the end and parts of recordings, without a window."""

import math
import time
from dataclasses import replace

import numpy as np
import pytest

from cubeling.app.errors import AppError
from cubeling.app.pipeline.playground import Playground
from cubeling.app.pipeline.scenario import Inputs
from cubeling.app.running import runner
from cubeling.app.running.opening import open_session
from cubeling.app.running.playback import transport
from cubeling.app.running.playback.frame_feed import MAX_WAITING_S
from cubeling.app.running.playback.saved_states import FIRST_INTERVAL_S
from cubeling.app.running.runner import run
from cubeling.app.session import SessionOptions, messages, session_info
from cubeling.app.session.encoding import encode
from cubeling.app.ui.playback.requests import (
    MarkMoment,
    NameMark,
    Pause,
    Record,
    Seek,
    SeekTo,
    StepFrames,
)
from cubeling.app.workshop.moods.robot_traces import read_robot_traces
from cubeling.robot.protocol.timing import FAILSAFE_AFTER as FAILSAFE_S
from cubeling.tracking import Health
from tests.app import session_parts
from tests.app.conftest import LONGER_FRAMES as FRAMES
from tests.app.running.player import Player
from tests.app.running.recorded_camera import RecordedCamera
from tests.examples import some

LAST = FRAMES - 1
"""Number of the last frame."""


@pytest.fixture
def play(longer_session, tmp_path):
    """Play the longer session before a player; return the player.

    The cube is not tracked again, which takes most of the time, unless the settings say so.
    """

    def run_session(*script, **settings):
        player = Player(*script)
        options = SessionOptions(
            scenario="companion",
            source=str(longer_session),
            robot="none",
            folder=tmp_path,
            **{"stage": "controls", **settings},
        )
        with open_session(options, screen=player) as session:
            session.pace = None
            player.session = session
            player.summary = run(session)
        return player

    return run_session


@pytest.fixture(scope="module")
def straight(longer_session):
    """The messages of the frames, played one after the other."""
    player = Player()
    options = SessionOptions(scenario="companion", source=str(longer_session), robot="none")
    with open_session(options, screen=player) as session:
        session.pace = None
        run(session)
    assert player.indices == list(range(FRAMES))
    return player.messages()


@pytest.mark.full
@pytest.mark.slow(reason="a session is computed twice")
def test_after_a_seek_everything_is_as_if_all_frames_had_been_shown(play, straight):
    player = play(
        (28, SeekTo(0.7)),
        (32, SeekTo(0.3)),
        (36, Seek(0.7)),
        (38, SeekTo(math.inf)),
        stage="camera",
    )
    indices = player.indices
    assert indices[:36] == [*range(28), *range(21, 25), *range(9, 13)]
    assert indices[36] == 12 + 21
    assert indices[-1] == LAST
    steps_played = (
        len(indices) - 5
    )  # of the five stretches, each begins with a frame that follows none
    assert player.summary.duration == pytest.approx(steps_played / 30, abs=0.001)
    assert player.messages() == {index: straight[index] for index in set(indices)}


def test_a_pipeline_that_cannot_be_copied_is_run_again_from_the_start(play, straight, monkeypatch):
    def refuse(self):
        raise TypeError("cannot pickle")

    monkeypatch.setattr(Playground, "checkpoint", refuse)
    monkeypatch.setattr(runner, "PREVIEW_INTERVAL_S", 0.0)
    player = play((20, SeekTo(0.5)), (22, SeekTo(1.2)))
    assert player.indices == [*range(20), 15, 16, *range(36, FRAMES)]
    assert player.previews == [*range(15), *range(17, 36)], "nothing is seen on the way"
    assert player.messages() == {index: straight[index] for index in set(player.indices)}


@pytest.mark.parametrize(
    "acts", some([(((20, Record()), (24, Record())),), (((20, Inputs(clear=True)),),)])
)
def test_going_back_after_the_player_acted_is_as_short_and_shows_the_same(play, acts, monkeypatch):
    monkeypatch.setattr(runner, "PREVIEW_INTERVAL_S", 0.0)
    player = play(*acts, (40, SeekTo(1.2)), (42, SeekTo(0.5)), (44, leave), stage="camera")
    assert player.indices == [*range(40), 36, 37, 15, 16]
    assert len(player.previews) < 2 * 30 * FIRST_INTERVAL_S
    again = player.messages()
    for step in player.steps[36:38] + player.steps[15:17]:
        assert again[step.frame.index] == [encode(each) for each in step.messages().values()]


AS_THEN = {
    "stage": "camera",
    "cubes": ("companion",),
    "own_motions_only": True,
    "whole_limbs": False,
}
"""The settings with which the short session was recorded."""


def test_in_a_long_recording_a_far_seek_shows_what_was_recorded(play, straight, monkeypatch):
    monkeypatch.setattr(transport, "LONG_S", 1.0)
    monkeypatch.setattr(transport, "MAX_PROCESSED_FRAMES", 5)
    monkeypatch.setattr(runner, "PREVIEW_INTERVAL_S", 0.0)
    script = (3, SeekTo(1.2)), (6, SeekTo(0.9)), (9, Inputs(clear=True)), (12, leave)
    player = play(*script, **AS_THEN)
    assert player.indices == [0, 1, 2, 36, 37, 38, *range(27, 33)]
    assert not player.previews, "nothing is processed on the way"
    for step in player.steps[:9]:
        assert [encode(each) for each in step.messages().values()] == straight[step.frame.index]
    poses = [encode(step.posed) for step in player.steps[9:]]
    assert poses[-1] != straight[32][-2], "what the player asks for counts from there on"


def test_a_long_recording_begins_within_as_it_was_recorded(play, straight, monkeypatch):
    monkeypatch.setattr(transport, "LONG_S", 1.0)
    monkeypatch.setattr(runner, "PREVIEW_INTERVAL_S", 0.0)
    player = play((2, leave), start_s=1.2, **AS_THEN)
    assert (player.indices, player.previews) == ([36, 37], [])
    assert player.messages() == {index: straight[index] for index in (36, 37)}


def test_single_frames_are_shown_while_it_is_paused(play, straight):
    player = play(
        (30, Pause()),
        ("idle", StepFrames(-1)),
        ("idle", StepFrames(-1)),
        ("idle", StepFrames(1)),
        ("idle", Seek(-0.5)),
    )
    assert player.indices[30:] == [28, 27, 28, 13]
    assert player.statuses[-1].paused
    assert player.messages() == {index: straight[index] for index in set(player.indices)}


def test_at_the_end_it_waits_and_can_be_played_again(play):
    player = play(("idle", Pause()), (FRAMES + 3, SeekTo(math.inf)))
    assert player.indices == [*range(FRAMES), 0, 1, 2, LAST]
    assert player.statuses[-1].ending is not None
    assert player.statuses[-1].position.now == pytest.approx(LAST / 30, abs=0.01)


def leave(player):
    player.closed = True


def test_a_part_is_played_in_a_loop_until_the_player_leaves(play, straight):
    player = play((25, leave), start_s=0.5, end_s=0.8, loop=True)
    assert player.indices == [*range(15, 25), *range(15, 25), *range(15, 20)]
    assert player.messages() == {index: straight[index] for index in range(15, 25)}
    assert player.statuses[-1].position.start == 0.5


def test_after_a_seek_nothing_sounds_of_what_was_skipped(play):
    class Sound:
        """Notes the frames that may be heard, and where it begins anew."""

        def __init__(self):
            self.noted: list[int | str] = []
            self.problem = ""

        def play(self, step, character, started_over):
            self.noted.append(step.frame.index)

        def restart(self):
            self.noted.append("anew")

    def listen(player):
        player.session.sound = sound

    sound = Sound()
    play((0, listen), (3, Seek(0.5)), (5, SeekTo(0.0)), (7, leave))
    assert sound.noted == [0, 1, 2, "anew", 17, 18, "anew", 0, 1]


def test_nobody_seeks_out_of_the_part_that_is_played(play):
    player = play((2, Seek(-5.0)), (4, Seek(5.0)), start_s=0.6, end_s=1.1)
    assert player.indices == [18, 19, 18, 19, 33]


@pytest.mark.parametrize(
    ("part", "words"),
    [
        ({"start_s": 3.0}, "after the end of the recording"),
        ({"start_s": 1.0, "end_s": 0.5}, "nothing is left"),
        ({"start_s": -1.0}, "before it"),
        ({"loop": True, "pictures": False}, "needs a window"),
    ],
)
def test_a_part_that_makes_no_sense_is_refused(play, part, words):
    with pytest.raises(AppError, match=words):
        play(**part)


def test_a_recording_by_key_is_a_session_of_its_own(play, longer_session):
    script = (10, Record()), (12, Seek(-0.5)), (22, Record()), (25, SeekTo(0.0)), (26, leave)
    player = play(*script, stage="camera")
    (path,) = player.session.recorded
    assert path.name.startswith("companion-20")
    assert session_info(path).frames == 12
    assert start_of(path) == pytest.approx(10 / 30, abs=0.001)
    options = SessionOptions(scenario="companion", source=str(path))
    assert session_parts.check(path, options).identical
    assert player.indices[24:] == [24, 0]  # only after the recording
    assert player.notices == [
        f"Recording from the start: {path}",
        "A recording stays as it began: no seeking in it",
        f"Recorded 0 s. Play it: cubeling replay {path}",
    ]
    assert player.statuses[20].recording == pytest.approx(0.3, abs=0.1)
    assert player.statuses[-1].recording is None


def test_marks_by_key_are_events_of_the_recording(play):
    script = (
        (5, MarkMoment()),
        (10, Record()),
        (14, MarkMoment()),
        (16, NameMark("error: fell")),
        (18, MarkMoment()),
        (22, leave),
    )
    player = play(*script, stage="camera")
    (path,) = player.session.recorded
    marks = {name: time for time, name in session_parts.events(path) if name.startswith("mark")}
    first, second = pytest.approx(13 / 30), pytest.approx(17 / 30)
    assert marks == {"mark 1": first, "mark 1: error: fell": first, "mark 2": second}
    assert player.notices[0] == "Marks are kept in a recording: R begins one"
    assert player.notices[2:5] == [
        "Mark 1 at 0.1 s: a digit, or a name and Enter",
        "Mark 1: error: fell",
        "Mark 2 at 0.2 s: a digit, or a name and Enter",
    ]


def test_a_recording_of_a_part_is_a_session_of_its_own(cubeling, longer_session, tmp_path):
    code, _, err = cubeling(
        "replay", longer_session, "--no-pictures", "--start", 0.5, "--end", 1, "--record", "a.mcap"
    )
    assert (code, err) == (0, "")
    assert session_info(tmp_path / "a.mcap").frames == 16
    code, _, err = cubeling("replay", "a.mcap", "--check")
    assert (code, err) == (0, "")


def start_of(path):
    return next(time for _, time, _ in messages(path, "/camera/image"))


class LiveSession(RecordedCamera):
    """A live camera whose time goes on while the session pauses."""

    def __init__(self, session):
        super().__init__(session, 20)
        self.late = 0.0
        self.health = Health("camera 0", "running", 0.0)

    def wait(self, timeout, patience=None):
        frame = next(self._frames, None)
        if frame is None:
            self.health = replace(self.health, state="closed")
            return None
        return replace(frame, timestamp=1000.0 + frame.timestamp + self.late)


def test_a_pause_of_a_live_session_leaves_no_gap_and_keeps_the_robot(longer_session, tmp_path):
    camera = LiveSession(longer_session)

    def pass_time(player):
        """Be away for longer than a robot waits for its host."""
        time.sleep(FAILSAFE_S + 0.2)
        camera.late = 60.0
        states.append(player.session.robot.view().link)
        return Pause()

    states: list[str] = []
    player = Player((10, Pause()), ("idle", pass_time), (15, leave))
    path = tmp_path / "out.mcap"
    options = SessionOptions(
        scenario="companion", source="camera:0", robot="sim", record=path, pictures=False
    )
    with camera, open_session(options, source=camera, screen=player) as session:
        player.session = session
        run(session)
    stamps = [step.frame.timestamp for step in player.steps]
    np.testing.assert_allclose(np.diff(stamps), 1 / 30, atol=1e-4)
    assert len(stamps) == 15
    assert session_parts.check(path, replace(options, source=str(path), record=None)).identical
    assert states == ["ready"]
    wire = [time for _, time, _ in messages(path, "/robot/wire")]
    assert max(wire) < stamps[-1] + 1.0
    assert read_robot_traces(path)  # the robot was never lost, or its trace would end
    assert [event for _, event in session_parts.events(path) if event in ("paused", "resumed")] == [
        "paused",
        "resumed",
    ]


class HastyCamera(LiveSession):
    """A live camera that has newer frames waiting, but for every fourth one."""

    max_waiting = 1

    def __init__(self, session):
        super().__init__(session)
        self.kept: list[int] = []

    def wait(self, timeout, patience=None):
        self.kept.append(self.max_waiting)
        return super().wait(timeout, patience)

    @property
    def waiting(self):
        return len(self.kept) % 4


def test_a_recording_has_every_frame_of_a_camera_that_is_too_fast(longer_session, tmp_path):
    camera, player, path = HastyCamera(longer_session), Player(), tmp_path / "out.mcap"
    options = SessionOptions(
        scenario="companion", source="camera:0", robot="none", record=path, pictures=False
    )
    with camera, open_session(options, source=camera, screen=player) as session:
        summary = run(session)
    assert set(camera.kept) == {round(MAX_WAITING_S * camera.rate)}
    assert session_info(path).frames == summary.frames == 20
    assert 4 <= len(player.steps) <= 8
    assert session_parts.check(path, replace(options, source=str(path), record=None)).identical
