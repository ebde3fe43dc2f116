"""What Pleo's tests share: a driver and a console in virtual time, scripted or simulated."""

import re
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from cubeling.affect import Emotion
from cubeling.robot.drivers.pleo.driver import PleoDriver
from cubeling.robot.drivers.pleo.settings import load_settings
from cubeling.robot.simulators.pleo.simulator import PleoSimulator

STEP_S = 0.005
"""The link's thread turns this often [s]."""

NAME = r"[!-~¡-ÿ]{1,64}"
ALLOWED = re.compile(
    rf"(|APP UNLOAD|JOINT NEUTRAL|STATS POWER|JOINT MOVE \d{{1,2}} -?\d{{1,2}}"
    rf"|MOTION PLAY {NAME}|SOUND PLAY {NAME}"
    r"|MOTION SPEED \d{1,3}|SOUND SPEED \d{1,3}|SOUND VOLUME \d{1,3})"
)
"""Every command that the driver may ever send."""


POSES = """
[moods.neutral]
joints = {}
[moods.angry]
joints = { torso = -9.2, "tail up" = 45, "left hip" = -45, "left shoulder" = 45 }
[moods.sad]
joints = { torso = 8, "left shoulder" = -30 }
[moods.happy]
motion = "a:happy.umf"
length_s = 3
loop = false
"""
"""Moods that are poses, and one that is a motion without a loop."""


class DriverOnClock:
    """A driver on a virtual clock."""

    def __init__(self, now: float, path=None) -> None:
        self.now = now
        self.driver = PleoDriver(load_settings(path))
        self.driver.port_opened(now)

    def express(self, label: str) -> None:
        self.driver.express(Emotion(0.0, 0.0, label))

    @property
    def state(self) -> str:
        return self.driver.state(self.now)

    @property
    def telemetry(self):
        return self.driver.telemetry(self.now)


class Script(DriverOnClock):
    """A driver, and a console whose every byte the test says."""

    def __init__(self, path=None) -> None:
        super().__init__(50.0, path)

    def run(self, seconds: float) -> bytes:
        """Let time pass; return what the driver sent meanwhile."""
        sent = b""
        for _ in range(max(round(seconds / STEP_S), 1)):
            self.now += STEP_S
            self.driver.tick(self.now)
            sent += self.driver.bytes_to_send()
        return sent

    def say(self, text: str, seconds: float = 0.4) -> bytes:
        """Let the console say something; return what the driver sent after it."""
        self.driver.receive(text.encode("latin-1"), self.now)
        return self.run(seconds)

    def auto(self, seconds: float, reply: str = "\r\n> ") -> list[str]:
        """Let time pass with a console that answers everything; return the commands sent.

        An answer takes 20 ms. Empty lines are answered, and left out of what is returned.
        """
        sent: list[str] = []
        answers = [self.now] if self.driver.console.pending else []
        for _ in range(round(seconds / STEP_S)):
            lines = self.run(STEP_S).decode("latin-1").split("\n")[:-1]
            sent += [line for line in lines if line]
            answers += [self.now + 0.020 for _ in lines]
            if answers and self.now >= answers[0]:
                answers.pop(0)
                self.driver.receive(reply.encode("latin-1"), self.now)
        return sent

    def started(self) -> "Script":
        """Go through the start, and the first question for the battery."""
        assert self.run(STEP_S) == b"\n"
        assert self.say("> ") == b"APP UNLOAD\n"
        assert self.say("\r\n> ") == b"JOINT NEUTRAL\n"
        assert self.say("> ") == b"SOUND VOLUME 70\n"
        assert self.say("> ") == b"STATS POWER\n"
        assert self.say("Battery sensor value = 80 (820)\r\n> ") == b""
        assert self.state == "ready"
        return self

    def show(self, label: str) -> "Script":
        """Request a mood, and let the console answer everything for a second."""
        self.express(label)
        self.auto(1.0)
        return self


class PleoWorld(DriverOnClock):
    """A driver and a simulated Pleo on one virtual clock."""

    def __init__(self, seed: int = 0, cut_reads: bool = False, path=None) -> None:
        super().__init__(100.0, path)
        self.random = np.random.default_rng(seed + 1000)
        self.robot = PleoSimulator(seed)
        self.cut_reads = cut_reads
        self.unplugged = self.silent = False
        self.sent: list[tuple[float, str]] = []
        self.heard_at = self.now
        self._late = b""

    def run(self, seconds: float, each: Callable[[], None] = lambda: None) -> None:
        for _ in range(round(seconds / STEP_S)):
            self.now += STEP_S
            self._turn()
            each()

    def run_until(self, condition: Callable[[], bool], within: float) -> float:
        start = self.now
        while not condition():
            assert self.now - start < within, f"not within {within} s of virtual time"
            self.run(STEP_S)
        return self.now - start

    def playing(self, label: str) -> bool:
        """Whether this mood's motion is what was last begun, and it still runs or just ended."""
        played = [one for one in self.robot.body.played if one.kind == "motion"]
        return bool(played) and played[-1].name == f"a:{label}.umf"

    def _turn(self) -> None:
        if self.unplugged:
            return
        self.robot.advance(self.now)
        data = self._late + self.robot.bytes_to_send()
        cut = int(self.random.integers(len(data) + 1)) if self.cut_reads and data else len(data)
        data, self._late = data[:cut], data[cut:]
        if self.silent:
            data, self._late = b"", b""
        if data:
            self.heard_at = self.now
        self.driver.receive(data, self.now)
        self.driver.tick(self.now)
        sent = self.driver.bytes_to_send()
        self.sent += [(self.now, line) for line in sent.decode("latin-1").split("\n")[:-1]]
        if not self.silent:
            self.robot.receive(sent, self.now)


@pytest.fixture
def script() -> Callable[..., Script]:
    """Make a scripted console: `script().started()`."""
    return Script


@pytest.fixture
def pleo_world() -> Callable[..., PleoWorld]:
    """Make a simulated world: `pleo_world(seed=1)`."""
    return PleoWorld


@pytest.fixture
def allowed() -> re.Pattern[str]:
    """Give the pattern of all commands that may be sent."""
    return ALLOWED


@pytest.fixture
def settings_file(tmp_path) -> Callable[[str], Path]:
    """Write a person's own settings: `settings_file(text)`."""

    def write(text: str) -> Path:
        path: Path = tmp_path / "mine.toml"
        path.write_text(text)
        return path

    return write


@pytest.fixture
def poses(settings_file) -> Script:
    """Make a console that has started, with the moods in `POSES`."""
    return Script(settings_file(POSES)).started()
