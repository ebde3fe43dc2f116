"""Ports: what pySerial opens, and a simulated robot that reads and writes like one."""

import re
import sys
import threading
import time
from collections.abc import Callable
from typing import Protocol, cast
from urllib.parse import parse_qsl

import serial

from robot import timing
from robot.errors import RobotError
from robot.simulator import Simulator

Clock = Callable[[], float]

_REFUSALS: tuple[type[Exception], ...] = (OSError, ValueError)  # SerialException is an OSError
if sys.platform != "win32":
    import termios

    _REFUSALS += (termios.error,)  # pySerial lets it through where a port vanishes while it opens

READ_TIMEOUT = 0.005
"""Longest wait in one read [s]: how late a beat or a repeat may be, and a close be noticed."""

WRITE_TIMEOUT = 0.2
"""Longest wait in one write [s]; a robot that no longer reads makes its line fill up."""


class Port(Protocol):
    """The part of pySerial's interface that a link uses."""

    @property
    def in_waiting(self) -> int:
        """Bytes that can be read at once."""

    def read(self, size: int = 1, /) -> bytes:
        """Read up to `size` bytes, waiting a bounded time for them."""

    def write(self, data: bytes, /) -> int | None:
        """Write all of the bytes, or raise after a bounded time."""

    def close(self) -> None:
        """Give the port back."""


SIMULATORS: dict[str, Callable[[int], Simulator]] = {"cubeling": Simulator}
"""The simulated robots by name, as in "sim:cubeling"; made from a seed."""


_NO_PORT = "there is no such port; `cubeling robot list` shows those there are"
_NOT_SERIAL = "that is no serial port; `cubeling robot list` shows those there are"
_REASONS = {
    "FileNotFoundError": _NO_PORT,
    "No such file": _NO_PORT,
    "Inappropriate ioctl": _NOT_SERIAL,
    "Is a directory": _NOT_SERIAL,
    "exclusively lock": "another program is using it",
    "Permission": "no permission; on Linux join the group dialout, elsewhere close other programs",
    "Access is denied": "another program is using it",
    "refused": "nobody listens there",
    "timed out": "nobody answers there",
}
"""Signs in the systems' messages, and what they mean."""


def open_port(url: str, clock: Clock = time.monotonic) -> Port:
    """Open a port.

    Parameters
    ----------
    url
        Whatever pySerial opens: "/dev/ttyACM0", "COM3", "socket://localhost:5000"; or "sim:NAME",
        "sim:NAME?seed=7" for a simulated robot.
    clock
        The time by which a simulated robot lives.

    Raises
    ------
    RobotError
        If it does not open; the line says why.
    """
    if not url:
        raise RobotError("a port must be named; `cubeling robot list` shows those there are")
    if url.startswith("sim:"):
        return MemoryPort(_simulator_of(url), clock)
    try:
        port = serial.serial_for_url(
            url,
            baudrate=timing.BAUD,
            timeout=READ_TIMEOUT,
            write_timeout=WRITE_TIMEOUT,
            exclusive=True,  # two programs on one port look like a broken robot to both
        )
    except _REFUSALS as error:
        shown = url if url.isprintable() else repr(url)
        raise RobotError(f"cannot open the port {shown}: {_reason(url, error)}") from error
    return cast(Port, port)


def _simulator_of(url: str) -> Simulator:
    name, _, query = url.removeprefix("sim:").partition("?")
    if name not in SIMULATORS:
        known = ", ".join(f"sim:{one}" for one in SIMULATORS)
        raise RobotError(f"there is no simulated robot {url!r}; there is {known}")
    options = dict(parse_qsl(query, keep_blank_values=True))
    seed = options.pop("seed", "0")
    if options:
        raise RobotError(f"{url!r}: {next(iter(options))!r} is no option of a simulator; seed is")
    if not (seed.isascii() and seed.isdigit()):
        raise RobotError(f"{url!r}: the seed must be a whole number from 0, not {seed!r}")
    return SIMULATORS[name](int(seed))


def _reason(url: str, error: Exception) -> str:
    """Say in a person's words why a port does not open; pySerial's own where none is known."""
    text = " ".join(str(error).split())
    for sign, words in _REASONS.items():
        if sign in text:
            return words
    if url.startswith("socket://") and "Errno" not in text:
        return "a socket needs a host and a port, as in socket://localhost:5000"
    return re.sub(r"^.*\[Errno -?\d+\] ", "", text)


class MemoryPort:
    """A simulated robot behind pySerial's interface, without a port.

    The robot lives while it is read from; a closed port stops its time.
    """

    def __init__(self, simulator: Simulator, clock: Clock) -> None:
        self.simulator = simulator
        """The robot at the other end."""
        self._clock = clock
        self._arrived = bytearray()
        self._open = True
        self._cancelled = threading.Event()

    @property
    def in_waiting(self) -> int:
        """Bytes that can be read at once."""
        self._live()
        return len(self._arrived)

    def read(self, size: int = 1, /) -> bytes:
        """Read up to `size` bytes; waits at most `READ_TIMEOUT` for the first."""
        self._live()
        if not self._arrived:
            self._cancelled.wait(READ_TIMEOUT)
            self._cancelled.clear()
            self._live()
        data = bytes(self._arrived[:size])
        del self._arrived[:size]
        return data

    def write(self, data: bytes, /) -> int:
        """Hand the bytes to the robot."""
        self._live()
        self.simulator.receive(data, self._clock())
        return len(data)

    def cancel_read(self) -> None:
        """End a read that waits, as pySerial's does."""
        self._cancelled.set()

    def close(self) -> None:
        """Stop the robot's time."""
        self._open = False

    def _live(self) -> None:
        if not self._open:
            raise serial.PortNotOpenError
        self.simulator.advance(self._clock())
        self._arrived += self.simulator.bytes_to_send()
