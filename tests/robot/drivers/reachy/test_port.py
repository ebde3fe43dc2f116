"""The SDK behind the interface of a port: with a stand-in for it here, and with its own simulator
where it is installed."""

import dataclasses
import importlib.util
import os
import signal
import socket
import subprocess
import sys
import threading
from types import SimpleNamespace

import numpy as np
import pytest
import serial

from cubeling import robot
from cubeling.affect import Emotion
from cubeling.robot.drivers import DRIVERS
from cubeling.robot.drivers.reachy import driver, port
from cubeling.robot.drivers.reachy.port import ReachyPort, open_reachy
from cubeling.robot.drivers.reachy.sdk import head_angles, head_pose
from cubeling.robot.errors import RobotError

HAPPY = Emotion(0.8, 0.6, "happy")
INSTALLED = importlib.util.find_spec("reachy_mini") is not None


class StandIn:
    """What the line calls of the SDK; remembers it."""

    def __init__(self, mode: str = "enabled") -> None:
        self.mode = mode
        self.calls: list[str] = []
        self.targets: list[np.ndarray] = []
        self.dead = False
        self.hangs: threading.Event | None = None
        self.client = SimpleNamespace(
            get_status=self.status, is_connected=lambda: not self.dead, disconnect=lambda: None
        )

    def status(self, wait: bool = True, timeout: float = 0.0) -> SimpleNamespace:
        backend = SimpleNamespace(motor_control_mode=SimpleNamespace(value=self.mode))
        return SimpleNamespace(version="9.9", backend_status=backend)

    def enable_motors(self) -> None:
        self.mode = "enabled"
        self.calls.append("on")

    def goto_target(self, head, antennas, duration, body_yaw) -> None:
        self.calls.append(f"go {duration:g}")

    def set_target(self, head, antennas, body_yaw) -> None:
        if self.hangs is not None:
            self.hangs.wait(5.0)
        if self.dead:
            raise ConnectionError
        self.targets.append(np.array([*head_angles(head), body_yaw, *antennas]))

    def get_current_joint_positions(self):
        return [0.25, *[0.0] * 6], [0.1, -0.1]

    def get_current_head_pose(self):
        return head_pose(0.1, -0.2, 0.3)


@pytest.fixture
def connected(monkeypatch):
    """Connect to a stand-in: `connected(mini)`."""

    def connect(mini):
        def opener(url, clock):
            return lambda: ReachyPort("here", 1, lambda *_: mini)

        kind = dataclasses.replace(DRIVERS["reachy"], opener=opener)
        monkeypatch.setitem(DRIVERS, "reachy", kind)
        return robot.connect("reachy:here")

    return connect


def test_a_mood_reaches_the_robot_and_what_it_measures_comes_back(connected, soon):
    mini = StandIn()
    with connected(mini) as reachy:
        assert reachy.catalogue.firmware == "daemon 9.9"
        reachy.express(HAPPY)
        soon(lambda: reachy.telemetry.acknowledged == HAPPY)
        soon(lambda: len(mini.targets) > 3)
        joints = reachy.telemetry.joints
        assert joints["head pitch"] == pytest.approx(-0.2)
        assert joints["body yaw"] == pytest.approx(0.25)
    assert mini.calls == ["go 1", "go 1"]  # slowly to where it begins, and back there at the end


def test_a_hanging_robot_delays_nothing(connected, soon, monkeypatch):
    monkeypatch.setattr(driver, "LOST_AFTER_S", 0.6)
    monkeypatch.setattr(port, "LEAVE_TIMEOUT_S", 0.1)
    mini = StandIn()
    mini.hangs = threading.Event()
    with connected(mini) as reachy:
        for index in range(100):
            reachy.express(Emotion(index / 1000, 0.5))
        soon(lambda: reachy.telemetry.state == "lost", within=4.0)
    mini.hangs.set()


def test_a_daemon_that_dies_is_a_port_that_is_unplugged_and_comes_back(connected, soon):
    mini = StandIn()
    with connected(mini) as reachy:
        mini.dead = True
        soon(lambda: reachy.telemetry.state == "lost")
        mini.dead = False
        reachy.express(HAPPY)
        soon(lambda: reachy.telemetry.acknowledged == HAPPY)


def test_a_port_without_a_daemon_is_gone(soon):
    def refuse(host: str, port: int) -> None:
        raise ConnectionError

    line = ReachyPort("here", 1, refuse)

    def gone() -> bool:
        try:
            line.read(1)
        except serial.SerialException:
            return True
        return False

    soon(gone)
    line.close()


@pytest.mark.parametrize(
    ("url", "says"), [("here:x", "must be a number"), ("a b", "no name"), ("h:0", "number")]
)
def test_a_wrong_address_is_refused_in_one_line(url, says):
    with pytest.raises(RobotError, match=says):
        open_reachy(url, lambda: 0.0)


@pytest.mark.skipif(INSTALLED, reason="the SDK is installed")
def test_without_the_sdk_the_line_says_what_to_install():
    with pytest.raises(RobotError, match="pip install reachy-mini"):
        robot.connect("reachy:localhost")


@pytest.mark.skipif(not INSTALLED, reason="Reachy Mini's SDK is not installed")
def test_its_own_simulator_shows_moods_dies_and_comes_back(soon):
    with socket.create_server(("127.0.0.1", 0)) as free:
        number = free.getsockname()[1]
    main = "from reachy_mini.daemon.app.main import main; main()"
    options = ["--mockup-sim", "--headless", "--no-media", "--dataset-update-interval", "0"]
    command = [sys.executable, "-c", main, *options, "--fastapi-port", str(number)]
    quiet = subprocess.DEVNULL
    url = f"reachy:127.0.0.1:{number}"

    def connected():
        try:
            return robot.connect(url)
        except RobotError:
            return None

    daemon = subprocess.Popen(command, stdout=quiet, stderr=quiet)
    try:
        reachy = None
        for _ in range(20):  # a try takes a few seconds, as the daemon does to start
            reachy = reachy or connected()
        assert reachy is not None
        with reachy:
            reachy.express(HAPPY)
            soon(lambda: reachy.telemetry.acknowledged == HAPPY)
            soon(lambda: abs(reachy.telemetry.joints["right antenna"]) > 0.2, within=10)
            os.kill(daemon.pid, signal.SIGKILL)
            daemon.wait(5)
            soon(lambda: reachy.telemetry.state == "lost", within=4)
            daemon = subprocess.Popen(command, stdout=quiet, stderr=quiet)
            soon(lambda: reachy.telemetry.state == "ready", within=60)
            soon(lambda: reachy.telemetry.acknowledged == HAPPY)
    finally:
        daemon.kill()
        daemon.wait(5)
