"""SIGTERM and a closed terminal end every command in good order, with one exit code each."""

import signal
import subprocess
import sys
import threading
import time
from contextlib import contextmanager
from pathlib import Path

import av
import pytest

from cubeling.app.interrupts import ENDING_S, Termination
from cubeling.app.session import session_info
from cubeling.robot import SimulatedPort, simulator_of

pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="there are no such signals")

WAIT_S = 60.0
"""Real time after which a program that neither begins nor ends has failed."""

RECORDING = Path(__file__).parents[3] / "recordings" / "companion.mcap"

PROGRAM = """
import signal
for number in (signal.SIGTERM, signal.SIGHUP, signal.SIGINT):
    signal.signal(number, signal.default_int_handler if number == signal.SIGINT else signal.SIG_DFL)
from cubeling.app.entry import main
main()
"""
"""As in a terminal: what nohup starts begins with SIGHUP ignored, and so do the tests."""


@contextmanager
def started(*arguments, folder):
    """Run the program in a folder, and end it whatever happens."""
    command = [sys.executable, "-c", PROGRAM, *map(str, arguments)]
    with subprocess.Popen(
        command, cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True
    ) as child:
        try:
            yield child
        finally:
            child.kill()


def until(child, words):
    """Read what a program prints, up to a line with these words."""
    printed = ""
    while words not in printed:
        line = child.stdout.readline()
        assert line, f"it ended before it printed {words!r}: {printed}"
        printed += line


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGHUP], ids=["SIGTERM", "SIGHUP"])
def test_a_simulated_robot_ends_with_the_code_of_the_signal(number, tmp_path):
    with started("robot", "simulate", "--seconds", "60", folder=tmp_path) as child:
        until(child, "A robot listens")
        child.send_signal(number)
        assert child.wait(WAIT_S) == 128 + number


@pytest.mark.parametrize(
    ("arguments", "begun"),
    [
        (("behave", "--serve", "0", "--no-window"), "Blocks of BML come in"),
        (("robot", "conform", "sim:cubeling"), "hello answered"),
    ],
    ids=["behave", "conform"],
)
@pytest.mark.full  # programs are started; the next test is of a session that plays
def test_commands_end_with_the_code_of_the_signal(arguments, begun, tmp_path):
    with started(*arguments, folder=tmp_path) as child:
        until(child, begun)
        child.send_signal(signal.SIGTERM)
        assert child.wait(WAIT_S) == 143


@pytest.mark.slow(reason="a program is started, and plays")
def test_a_session_that_is_terminated_is_whole_and_its_robot_neutral(tmp_path):
    path, simulator = tmp_path / "x.mcap", simulator_of("cubeling")
    camera = ("--source", "synthetic:companion?size=320x180", "--no-pictures")
    with SimulatedPort(simulator) as port:
        robot = ("--robot", port.url)
        with started(
            "play", "companion", *camera, *robot, "--record", path, folder=tmp_path
        ) as run:
            waiting, end = threading.Event(), time.monotonic() + WAIT_S
            while not path.exists() or path.stat().st_size < 20_000:
                assert run.poll() is None
                assert time.monotonic() < end
                waiting.wait(0.02)
            run.send_signal(signal.SIGTERM)
            assert run.wait(WAIT_S) == 143
    assert session_info(path).frames > 0
    assert simulator.portrait()[0] == 0.0


@pytest.mark.full
def test_a_video_that_is_terminated_is_whole(tmp_path):
    with started("replay", RECORDING, "-o", "x.mp4", folder=tmp_path) as child:
        until(child, "%")
        child.send_signal(signal.SIGTERM)
        assert child.wait(WAIT_S) == 143
    with av.open(str(tmp_path / "x.mp4")) as video:
        assert sum(1 for _ in video.decode(video=0)) > 0


def test_several_signals_at_once_are_one_request(monkeypatch):
    now = 100.0
    monkeypatch.setattr(time, "monotonic", lambda: now)
    termination = Termination()
    assert termination.exit_code(2) == 2
    with pytest.raises(KeyboardInterrupt):
        termination(signal.SIGTERM, None)
    now += ENDING_S / 2
    termination(signal.SIGHUP, None)
    now += ENDING_S
    with pytest.raises(KeyboardInterrupt):
        termination(signal.SIGHUP, None)
    assert termination.exit_code(0) == 143
