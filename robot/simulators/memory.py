"""A simulated robot behind pySerial's interface, without a port: what "sim:NAME" opens."""

import threading
from urllib.parse import parse_qsl

import serial

from robot.errors import RobotError
from robot.port import READ_TIMEOUT, Clock
from robot.simulators import SIMULATORS
from robot.simulators.base import Simulated


class SimulatedWire:
    """A simulated robot, and the wire to it.

    Parameters
    ----------
    url
        "sim:NAME", with options: "sim:cubeling?seed=7".
    clock
        The time by which both live.

    Raises
    ------
    RobotError
        If the URL names no robot, or an option is wrong.
    """

    def __init__(self, url: str, clock: Clock) -> None:
        self.robot = simulator_of(url)
        """The robot at the far end."""
        self._clock = clock

    def open(self) -> "MemoryPort":
        """Plug in."""
        return MemoryPort(self.robot, self._clock)


def simulator_of(url: str) -> Simulated:
    """Make the simulated robot that a URL names."""
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


class MemoryPort:
    """A simulated robot behind pySerial's interface, without a port.

    The robot lives while it is read from; a closed port stops its time.
    """

    def __init__(self, simulator: Simulated, clock: Clock) -> None:
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
