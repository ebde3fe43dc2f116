"""What the tests of the driver for OpenCat share: a board, a line and a host on virtual time."""

import re
from collections.abc import Callable

import numpy as np
import pytest

from cubeling.affect import Emotion
from cubeling.robot.drivers.opencat.host import OpenCatHost
from cubeling.robot.drivers.opencat.settings import OpenCatSettings, load_settings
from cubeling.robot.simulators.opencat.quirks import BoardQuirks
from cubeling.robot.simulators.opencat.simulator import OpenCatSimulator

QUIET = BoardQuirks(slow=0.0, mangled=0.0, brown_outs=0.0, restless=0.0, battery_lasts=1e9)
"""A board without quirks."""

ALLOWED_LINE = re.compile(
    rb"(?:[?jd]|k[a-z][A-Za-z]+|i\d+ -?\d+(?: \d+ -?\d+)*|b\d+ \d+(?: \d+ \d+)*)\n"
)
"""The form of every line; simpler than in the driver, and independent of it."""

EMOTIONS = {
    "neutral": Emotion(0.0, 0.0, "neutral"),
    "happy": Emotion(0.7, 0.6, "happy"),
    "angry": Emotion(-0.7, 0.6, "angry"),
    "sad": Emotion(-0.6, -0.4, "sad"),
}
"""Emotions by words that the robot has."""


class Desk:
    """A host and a simulated robot on one virtual clock.

    Every line that the host sends is written down with its time, and judged at once.
    """

    def __init__(
        self,
        robot: OpenCatSimulator | None = None,
        settings: OpenCatSettings | None = None,
        step: float = 0.02,
        seed: int = 0,
        flip: float = 0.0,
        drop: float = 0.0,
    ) -> None:
        self.settings = settings or load_settings()
        self.host = OpenCatHost(self.settings)
        self.robot = robot or OpenCatSimulator(seed, quirks=QUIET)
        self.now = 100.0
        self.step = step
        self.sent: list[tuple[float, str]] = []
        self.plugged = True
        self.heard = b""
        self._random = np.random.default_rng(seed)
        self._flip, self._drop = flip, drop
        self._open: str | None = None  # the token of a command without an echo
        self.host.port_opened(self.now)

    def turn(self) -> None:
        """Let one step of time pass."""
        self.now = round(self.now + self.step, 6)
        if not self.plugged:
            self.robot.advance(self.now)
            self.robot.bytes_to_send()
            self.host.tick(self.now)
            assert self.host.bytes_to_send() == b""
            return
        self.robot.advance(self.now)
        self._hear(self._harmed(self.robot.bytes_to_send()))
        self.host.tick(self.now)
        self._pass(self.host.bytes_to_send())

    def run(self, seconds: float, each: Callable[[], None] = lambda: None) -> None:
        for _ in range(round(seconds / self.step)):
            self.turn()
            each()

    def until(self, condition: Callable[[], bool], within: float) -> float:
        """Run until something is true; return how long that took [s]."""
        start = self.now
        while not condition():
            assert self.now - start < within, f"not within {within} s of virtual time"
            self.turn()
        return self.now - start

    def ready(self) -> "Desk":
        self.until(lambda: self.state == "ready", 30.0)
        return self

    def feel(self, word: str) -> None:
        self.host.express(EMOTIONS[word])

    def settle(self, within: float = 20.0) -> float:
        """Run until the robot has confirmed what was last asked for."""
        return self.until(self.settled, within)

    def settled(self) -> bool:
        known = self.telemetry
        return known.acknowledged is not None and known.acknowledged == known.commanded

    def unplug(self) -> None:
        self.plugged = False
        self.host.port_lost()

    def plug(self) -> None:
        self.plugged = True
        self._open = None
        self.host.port_opened(self.now)

    @property
    def state(self) -> str:
        return self.host.state(self.now)

    @property
    def telemetry(self):
        return self.host.telemetry(self.now)

    @property
    def lines(self) -> list[str]:
        return [line for _, line in self.sent]

    @property
    def shown(self) -> str:
        return self.robot.portrait()[1]

    def _harmed(self, data: bytes) -> bytes:
        if not data or not (self._flip or self._drop):
            return data
        kept = bytearray()
        for byte in data:
            chance = self._random.random()
            if chance < self._drop:
                continue
            wrong = chance < self._drop + self._flip
            kept.append(byte ^ (1 << int(self._random.integers(8))) if wrong else byte)
        return bytes(kept)

    def _hear(self, data: bytes) -> None:
        self.heard += data
        *lines, self.heard = self.heard.split(b"\n")
        for line in lines:
            word = line.strip(b"\r\0 \t").decode("latin-1")
            if word in ("?", "j", self._open) or b"* Start *" in line or b"rst:0x" in line:
                self._open = None
        self.host.receive(data, self.now)

    def _pass(self, data: bytes) -> None:
        if not data:
            return
        assert data.count(b"\n") == 1, f"two lines at once: {data!r}"
        assert ALLOWED_LINE.fullmatch(data), f"not to be sent: {data!r}"
        line = data.decode().strip()
        if self.sent:
            gap = self.now - self.sent[-1][0]
            assert gap >= 1.0 / self.settings.commands_per_s - 1e-6, f"too soon: {data!r}"
        if line not in ("?", "j"):
            assert self._open is None, f"{line!r} while {self._open!r} is on its way"
            self._open = line[0]
        self.sent.append((self.now, line))
        self.robot.receive(data, self.now)


@pytest.fixture
def desk() -> Callable[..., Desk]:
    """Make a desk: `desk(seed=3)`."""
    return Desk


@pytest.fixture
def quiet() -> BoardQuirks:
    """A board without quirks."""
    return QUIET
