"""The firmware in virtual time, on a board that only records."""

import contextlib
import threading
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import pytest

from cubeling.robot.firmware.dino import servos
from cubeling.robot.firmware.dino.board import RobotBoard
from cubeling.robot.firmware.dino.joints import ServoJoints
from cubeling.robot.firmware.dino.log import LogQueue
from cubeling.robot.firmware.dino.messages import SEVERITY_INFO
from cubeling.robot.firmware.dino.pty_board import PtyBoard
from cubeling.robot.firmware.dino.robot import Firmware, run
from cubeling.robot.firmware.dino.table import ServoTable
from cubeling.robot.protocol.schema import pack, unpack
from cubeling.robot.protocol.timing import VERSION
from cubeling.robot.protocol.wire import FrameReader, encode_frame


@dataclass(frozen=True)
class Pulse:
    """A change of a servo's pulse width."""

    time: int
    """Time [ms]."""

    pin: int
    us: int
    """Pulse width [µs]; 0 for no pulses."""


class VirtualBoard(RobotBoard):
    """A board whose line and time the test controls."""

    def __init__(self) -> None:
        self.now = 0
        self.incoming = b""
        self.outgoing = b""
        self.takes = 10_000
        """How many bytes the line takes at once."""
        self.pulses: list[Pulse] = []
        self.tones: list[int] = []
        self.dead = False
        """Whether the servo driver is unplugged."""
        self.watched = 0

    def read(self, data: bytearray) -> int:
        taken, self.incoming = self.incoming[: len(data)], self.incoming[len(data) :]
        data[: len(taken)] = taken
        return len(taken)

    def write(self, data: memoryview) -> int:
        taken = bytes(data[: self.takes])
        self.outgoing += taken
        return len(taken)

    def pulse(self, pin: int, us: int) -> None:
        if self.dead:
            raise OSError(19, "no device")
        self.pulses.append(Pulse(self.now, pin, us))

    def tone(self, hertz: int) -> None:
        self.tones.append(hertz)

    def start_watchdog(self) -> None:
        self.watched += 1

    def feed_watchdog(self) -> None:
        pass


class FailingBoard(VirtualBoard):
    """A board whose program fails once, and goes on for some seconds."""

    fails_at = 200
    """The turn of the loop in which it fails."""

    turns = 0

    def elapsed(self) -> int:
        self.now += 5
        return 5

    def wait(self, ms: int) -> None:
        self.turns += 1
        if self.turns == self.fails_at:
            raise MemoryError("on purpose")

    def exit_requested(self) -> bool:
        return self.turns > 600


class Dino:
    """The firmware as a `Simulated` robot: times in seconds, bytes in and out."""

    edge = b"\0"

    def __init__(self, table: Any = servos) -> None:
        self.table = ServoTable(table)
        self.reboot()

    def reboot(self) -> None:
        self.board = VirtualBoard()
        self.joints = ServoJoints(self.table.servos, self.board)
        log = LogQueue()
        log.write(SEVERITY_INFO, "started", 0)
        self.robot = Firmware(self.board, self.table, self.joints, log)
        self.start: float | None = None

    def receive(self, data: bytes, now: float) -> None:
        self.board.incoming += data
        self.advance(now)

    def advance(self, now: float) -> None:
        if self.start is None:
            self.start = now
        self.board.now = round(1000 * (now - self.start))
        self.robot.step(self.board.now)
        while self.board.incoming:
            self.robot.step(self.board.now)

    def bytes_to_send(self) -> bytes:
        data, self.board.outgoing = self.board.outgoing, b""
        return data

    def portrait(self) -> tuple[float, str]:
        body = self.robot.body
        return body.valence / 10_000, body.moods[body.mood]

    # Helpers for tests.

    def sent(self) -> list[tuple[int, Any]]:
        """Return the messages that it has sent since the last call, with their sessions."""
        return [unpack(body, "robot") for body in FrameReader().feed(self.bytes_to_send())]

    def send(self, message: object, session: int = 1, version: int = VERSION) -> None:
        """Send it a message now."""
        self.board.incoming += encode_frame(pack(message, session, version))
        self.robot.step(self.board.now)

    def run(self, ms: int, step: int = 5) -> None:
        """Advance the time."""
        end = self.board.now + ms
        while self.board.now < end:
            self.board.now = min(self.board.now + step, end)
            self.robot.step(self.board.now)


@pytest.fixture
def dino() -> Dino:
    """Return a robot without a session."""
    return Dino()


@pytest.fixture
def desk() -> Iterator[PtyBoard]:
    """Run the firmware on a pseudo-terminal."""
    made = PtyBoard()

    def live() -> None:
        with contextlib.suppress(SystemExit):  # by `close`
            run(made, ServoTable(servos))

    thread = threading.Thread(target=live, daemon=True)
    thread.start()
    yield made
    made.close()
    thread.join(2)
    assert not thread.is_alive()
    made.release()
