"""A simulated hand that makes `CubeControls`, a command-line runner, and short sessions."""

import dataclasses
import functools
import itertools
import math
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import cv2
import moderngl
import numpy as np
import pytest

from cubeling.app import cli
from cubeling.app.commands.play import progress
from cubeling.app.pipeline.playground import Playground
from cubeling.app.pipeline.step import Step
from cubeling.app.running.kept_lens import intrinsics_for
from cubeling.app.session import Recorder, frame_encoder
from cubeling.tracking import CubeControls, open_source
from tests.app.scripted import play_script
from tests.bundled_characters import (
    bundled_characters_are_read_once as bundled_characters_are_read_once,
)
from tests.conftest import MakeOnce
from tests.drawn_once import desks_are_drawn_once as desks_are_drawn_once

FRAME = 1 / 30

SMALL = 640, 360
"""Size of the pictures of short sessions [px]: they are decoded, searched and drawn in a third of
the time that whole ones take."""


SHORT_FRAMES = 30
"""Frames of a short session: its cube is found, and the robot has answered."""

LONGER_FRAMES = 40
"""Frames of one in which there is room to seek, and time to find that a cube is the wrong one."""


class Hand:
    """Makes `CubeControls` frame by frame, as a real hand would change them."""

    def __init__(self) -> None:
        self.controls = CubeControls(
            visible=True,
            top_face="top",
            heading=0.0,
            camera_angle=0.0,
            turns=0.0,
            resting=True,
            placed=True,
            lifted=False,
            position=np.zeros(2),
            timestamp=0.0,
            camera_from_table=np.eye(4),
            placements=1,
        )
        self.frames = 0

    def frame(self, **changes: Any) -> CubeControls:
        """Return the next frame: without events, otherwise unchanged unless `changes` says so."""
        now = round(self.frames * FRAME, 9)
        events = {"placed": False, "gestures": ()} if self.frames else {}
        fields: dict[str, Any] = {**events, **changes, "timestamp": now}
        self.controls = dataclasses.replace(self.controls, **fields)
        self.frames += 1
        return self.controls

    def heading(self, degrees: float) -> CubeControls:
        """Return the next frame with the cube turned to an angle from the camera."""
        turned = math.radians((degrees + 180) % 360 - 180)
        return self.frame(heading=turned, camera_angle=abs(turned))

    def turn(self, turns: float, seconds: float) -> list[CubeControls]:
        """Turn the cube by so many turns at constant speed."""
        count = round(seconds / FRAME)
        start = self.controls.turns
        return [self.frame(turns=start + turns * (i + 1) / count) for i in range(count)]

    def tip(self, face: str) -> list[CubeControls]:
        """Lift the cube, and put it down with another face on top."""
        lifted = [self.frame(resting=False, lifted=True) for _ in range(10)]
        placements = self.controls.placements + 1
        down = self.frame(
            resting=True, lifted=False, placed=True, top_face=face, turns=0.0, placements=placements
        )
        return [*lifted, down]

    def wait(self, seconds: float) -> list[CubeControls]:
        """Leave the cube alone."""
        return [self.frame() for _ in range(round(seconds / FRAME))]


@pytest.fixture
def hand() -> Hand:
    """A hand with the cube on the table, the top face up, the front to the camera."""
    return Hand()


@pytest.fixture(scope="session")
def bundled_session() -> Path:
    """A complete bundled session."""
    from cubeling.app.session.bundled import bundled_session

    return bundled_session("companion")


load_command_once = functools.cache(cli.load_command)
"""As a process runs one command, the program itself keeps none. To make one takes as long as a
step of a session, and hundreds are run here."""


@pytest.fixture
def cubeling(monkeypatch, capsys, tmp_path):
    """Run a command in an empty folder; return its exit code, output and error output."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(cli, "load_command", load_command_once)
    monkeypatch.setenv("COLUMNS", "200")
    monkeypatch.setattr(progress, "LINE_INTERVAL_S", math.inf)  # on a slow computer too
    for name in ("DISPLAY", "WAYLAND_DISPLAY"):
        monkeypatch.delenv(name, raising=False)

    def run(*arguments):
        monkeypatch.setattr(sys, "argv", ["cubeling", *map(str, arguments)])
        with pytest.raises(SystemExit) as caught:
            cli.main()
        captured = capsys.readouterr()
        return caught.value.code, captured.out, captured.err

    return run


@pytest.fixture(scope="session")
def scripted_session(make_once: MakeOnce) -> Callable[[str], Path]:
    """Return a session of the script of a bundled recording, with every channel."""

    def find(name: str) -> Path:
        return make_once(f"script-of-{name}.mcap", lambda path: play_script(name, record=path))

    return find


@pytest.fixture(scope="session")
def short_session(make_once: MakeOnce, bundled_session: Path) -> Path:
    """The first frames of a bundled session, recorded again with small pictures."""
    return make_once("short.mcap", lambda path: first_frames(bundled_session, SHORT_FRAMES, path))


@pytest.fixture(scope="session")
def longer_session(make_once: MakeOnce, bundled_session: Path) -> Path:
    """The same with a few more frames."""
    return make_once("longer.mcap", lambda path: first_frames(bundled_session, LONGER_FRAMES, path))


@pytest.fixture(scope="session")
def lifting_session(make_once: MakeOnce, bundled_session: Path) -> Path:
    """Every other frame of four seconds of a bundled session, in which the cube is lifted."""
    return make_once("lift.mcap", lambda path: first_frames(bundled_session, 120, path, every=2))


def first_frames(session: Path, count: int, path: Path, every: int = 1) -> Path:
    """Record so many frames of a session again, with small pictures; return the file."""
    about = {"scenario": "companion", "cube": "companion"}
    with open_source(str(session)) as source, Recorder(path, about) as recorder:
        encode = frame_encoder("auto", SMALL, source.rate / every)
        playground = Playground("companion", intrinsics_for(source.intrinsics, SMALL))
        recorder.camera(playground.intrinsics, 0.0)
        for frame in itertools.islice(source, 0, count, every):
            small_image = cv2.resize(frame.image, SMALL, interpolation=cv2.INTER_AREA)
            image = np.asarray(small_image, np.uint8)
            small = dataclasses.replace(frame, image=image, encoded=None, encoding="")
            recorder.write(playground.step(encode(small)))
    return path


@pytest.fixture
def a_step(bundled_session: Path) -> Callable[[moderngl.Context | None], Step]:
    """Return a function that makes the first step of a bundled session, drawn in a context."""

    def make(context: moderngl.Context | None) -> Step:
        with open_source(str(bundled_session)) as source:
            intrinsics = intrinsics_for(source.intrinsics, source.size)
            playground = Playground("companion", intrinsics, context=context)
            step = playground.step(next(iter(source)))
            playground.close()
        return step

    return make
