"""What the player exchanges while a session runs: the rest goes on."""

import shutil
import threading
import time
from contextlib import ExitStack, nullcontext
from dataclasses import replace
from importlib import resources

import cv2
import numpy as np
import pytest

from cubeling.app.running import opened_session
from cubeling.app.running.opening import open_session
from cubeling.app.running.playback import parts
from cubeling.app.running.playback.background import BackgroundCall
from cubeling.app.running.runner import run
from cubeling.app.session import SessionOptions, messages
from cubeling.app.ui.playback.requests import Choose, ListChoices, Record
from cubeling.robot import SimulatedPort
from cubeling.robot.link.ports import SerialPort
from cubeling.tracking import TrackingError
from tests.app.running.player import Player
from tests.app.running.test_transport import LiveSession


@pytest.fixture
def play(short_session, tmp_path):
    """Play a replay or a live session before a player; return the player."""

    def run_session(*script, live=False, **settings):
        player = Player(*script)
        options = SessionOptions(
            scenario="companion",
            source="camera:0" if live else str(short_session),
            folder=tmp_path,
            **{"robot": "none", **settings},
        )
        with ExitStack() as closing:
            source = closing.enter_context(LiveSession(short_session)) if live else None
            session = closing.enter_context(open_session(options, source=source, screen=player))
            session.pace = None
            player.session = session
            run(session)
        return player

    return run_session


def until(condition):
    """Return a function that waits for something that a thread does, 10 s at most."""

    def wait(player):
        deadline = time.monotonic() + 10.0
        while not condition(player) and time.monotonic() < deadline:
            time.sleep(0.005)

    return wait


def opened(player):
    """Whether nothing is being opened on a thread."""
    return not any(thread.name == "background call" for thread in threading.enumerate())


def leave(player):
    player.closed = True


def asked(part, value, at=6):
    """Choose something, wait for it, and leave a few pictures later."""
    return (at, Choose(part, value)), (at + 1, until(opened)), (at + 4, leave)


def test_another_character_goes_on_where_the_first_one_stands(play, tmp_path):
    path = tmp_path / "mine.glb"
    with resources.as_file(resources.files("cubeling.characters") / "assets" / "vleo.glb") as asset:
        shutil.copy(asset, path)
    player = play(*asked("character", str(path)))
    assert player.notices == [f"Opening {path} …", f"The character is now {path}"]
    assert player.session.playground.character.name == "mine"
    before, after = (player.steps[index].posed.table_from_character for index in (5, -1))
    np.testing.assert_allclose(before, after, atol=0.005)
    states = [step.state.visible for step in player.steps]
    assert all(states[5:]), "the cube is not searched anew"


@pytest.mark.parametrize(
    ("part", "value", "words"),
    [
        ("character", "robot", "robot cannot kiss or shout, as companion asks"),
        ("character", "nobody", "no bundled character 'nobody'; there are"),
        ("robot", "/dev/nothing", "/dev/nothing"),
    ],
)
def test_what_cannot_be_taken_is_said_in_one_line_and_the_present_one_stays(
    play, part, value, words
):
    player = play(*asked(part, value))
    assert words in player.notices[-1]
    assert "\n" not in player.notices[-1]
    assert player.session.options == player.session.asked
    assert len(player.steps) == 10


def test_another_robot_takes_over_in_the_midst_of_a_recording(play):
    with SimulatedPort() as port:
        player = play((3, Record()), *asked("robot", port.url), live=True)
        assert player.notices[-1] == f"The robot is now {port.url}"
        (path,) = player.session.recorded
        wire = [time for _, time, _ in messages(path, "/robot/wire")]
        before, after = (player.steps[index].frame.timestamp for index in (6, 7))
        assert before - 1e-6 <= min(wire) <= after + 1e-6


@pytest.mark.parametrize("players", [1, 2])
def test_another_camera_is_taken_without_a_gap_in_time(play, short_session, monkeypatch, players):
    class SmallCamera(LiveSession):
        """Another camera, whose pictures are smaller and whose clock shows another time."""

        def __init__(self):
            super().__init__(short_session)
            self.size, self.intrinsics, self.late = (640, 360), None, -500.0

        def wait(self, timeout, patience=None):
            frame = super().wait(timeout, patience)
            return frame and replace(frame, image=cv2.resize(frame.image, self.size))

    monkeypatch.setattr(opened_session, "open_source", lambda uri, size=None: SmallCamera())
    player = play(*asked("camera", "camera:1"), live=True, players=players)
    assert player.notices[-1] == "The camera is now camera:1"
    stamps = [step.frame.timestamp for step in player.steps]
    np.testing.assert_allclose(np.diff(stamps), 1 / 30, atol=1e-4)
    assert player.steps[-1].frame.image.shape == (360, 640, 3)
    assert player.session.playground.intrinsics.size == (640, 360)


def test_a_recording_keeps_its_camera_and_its_character(play):
    script = (3, Record()), (5, Choose("camera", "camera:1")), (6, Choose("character", "human"))
    player = play(*script, (8, leave), live=True)
    assert player.notices[1:] == [
        "A recording stays as it began: the camera stays",
        "A recording stays as it began: the character stays",
    ]


def test_several_players_are_told_why_their_scenario_stays(play):
    player = play((3, Choose("character", "human")), (5, leave), live=True, players=2)
    assert player.notices == ["Several players stay with what they play: the character stays"]


def test_cameras_that_open_are_listed_and_others_are_not(play, monkeypatch):
    def open_camera(uri, size=None):
        if uri == "camera:2":
            return nullcontext()
        raise TrackingError("no such camera")

    monkeypatch.setattr(parts, "open_source", open_camera)
    monkeypatch.setattr(parts, "_camera_uris", lambda: [f"camera:{n}" for n in range(3)])
    monkeypatch.setattr(parts, "serial_ports", lambda: [PLEO, BUILT_IN])
    player = play((3, ListChoices()), (4, until(opened)), (6, leave), live=True)
    shown = [(each.part, each.value, each.present) for each in player.statuses[-1].choices]
    assert shown == [
        ("camera", "camera:0", True),
        ("camera", "camera:2", False),
        ("character", "vleo", True),
        ("character", "human", False),
        ("character", "robot", False),
        ("robot", "none", True),
        ("robot", "sim", False),
        ("robot", "pleo:/dev/ttyUSB0", False),
    ]
    assert not player.statuses[-1].looking


PLEO = SerialPort("/dev/ttyUSB0", "Pleo rb", "a Pleo", 0x6962, 1)
BUILT_IN = SerialPort("/dev/ttyS0", "n/a", None, None, None)


def test_what_is_opened_too_late_is_closed():
    class Device:
        closed = threading.Event()

        def close(self):
            self.closed.set()

    go_on = threading.Event()

    def open_slowly():
        go_on.wait(10.0)
        return Device()

    call = BackgroundCall(open_slowly, parts.discard)
    assert not call.over
    call.close()
    go_on.set()
    assert Device.closed.wait(10.0)
