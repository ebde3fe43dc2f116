"""What Pleo's tests share: a driver and a console in virtual time, scripted or simulated."""

import re
from collections.abc import Callable

import numpy as np
import pytest

from affect import Emotion
from robot.drivers.pleo.driver import PleoDriver
from robot.drivers.pleo.settings import load_settings
from robot.simulators.pleo.simulator import PleoSimulator

STEP = 0.005
"""The link's thread turns this often [s]."""

NAME = r"[!-~¡-ÿ]{1,64}"
ALLOWED = re.compile(
    rf"(|APP UNLOAD|JOINT NEUTRAL|STATS POWER|JOINT MOVE \d{{1,2}} -?\d{{1,2}}"
    rf"|MOTION PLAY {NAME}|SOUND PLAY {NAME}"
    r"|MOTION SPEED \d{1,3}|SOUND SPEED \d{1,3}|SOUND VOLUME \d{1,3})"
)
"""Every command that the driver may ever send."""


class Script:
    """A driver, and a console whose every byte the test says."""

    def __init__(self, path=None) -> None:
        self.now = 50.0
        self.driver = PleoDriver(load_settings(path))
        self.driver.port_opened(self.now)

    def run(self, seconds: float) -> bytes:
        """Let time pass; return what the driver sent meanwhile."""
        sent = b""
        for _ in range(max(round(seconds / STEP), 1)):
            self.now += STEP
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
        for _ in range(round(seconds / STEP)):
            lines = self.run(STEP).decode("latin-1").split("\n")[:-1]
            sent += [line for line in lines if line]
            answers += [self.now + 0.020 for _ in lines]
            if answers and self.now >= answers[0]:
                answers.pop(0)
                self.driver.receive(reply.encode("latin-1"), self.now)
        return sent

    def started(self) -> "Script":
        """Go through the start, and the first question for the battery."""
        assert self.run(STEP) == b"\n"
        assert self.say("> ") == b"APP UNLOAD\n"
        assert self.say("\r\n> ") == b"JOINT NEUTRAL\n"
        assert self.say("> ") == b"SOUND VOLUME 70\n"
        assert self.say("> ") == b"STATS POWER\n"
        assert self.say("Battery sensor value = 80 (820)\r\n> ") == b""
        assert self.state == "ready"
        return self

    def express(self, label: str) -> None:
        self.driver.express(Emotion(0.0, 0.0, label))

    @property
    def state(self) -> str:
        return self.driver.state(self.now)

    @property
    def telemetry(self):
        return self.driver.telemetry(self.now)


class PleoWorld:
    """A driver and a simulated Pleo on one virtual clock."""

    def __init__(self, seed: int = 0, cut_reads: bool = False, path=None) -> None:
        self.random = np.random.default_rng(seed + 1000)
        self.now = 100.0
        self.driver = PleoDriver(load_settings(path))
        self.robot = PleoSimulator(seed)
        self.cut_reads = cut_reads
        self.unplugged = self.silent = False
        self.sent: list[tuple[float, str]] = []
        self.heard_at = self.now
        self._late = b""
        self.driver.port_opened(self.now)

    def run(self, seconds: float, each: Callable[[], None] = lambda: None) -> None:
        for _ in range(round(seconds / STEP)):
            self.now += STEP
            self._turn()
            each()

    def run_until(self, condition: Callable[[], bool], within: float) -> float:
        start = self.now
        while not condition():
            assert self.now - start < within, f"not within {within} s of virtual time"
            self.run(STEP)
        return self.now - start

    def express(self, label: str) -> None:
        self.driver.express(Emotion(0.0, 0.0, label))

    @property
    def state(self) -> str:
        return self.driver.state(self.now)

    @property
    def telemetry(self):
        return self.driver.telemetry(self.now)

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
