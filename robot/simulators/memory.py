"""A simulated robot behind pySerial's interface without a port: what "sim:NAME" opens."""

import re
import threading
from urllib.parse import parse_qsl

import serial

from cubeling.robot.contract.port import READ_TIMEOUT_S, Clock, Opener
from cubeling.robot.errors import RobotError
from cubeling.robot.simulators import SIMULATORS, Simulated
from cubeling.robot.simulators.faults import Faults, faults_of
from cubeling.robot.simulators.faulty import FaultyRobot


def open_simulated(url: str, clock: Clock) -> Opener:
    """Return a function that opens a simulated robot, now and after every unplugging.

    The robot and its line outlive every unplugging; for the URL see `simulator_of`.
    """
    robot = simulator_of(url)

    def open_port() -> MemoryPort:
        if isinstance(robot, FaultyRobot):
            robot.advance(clock())
            if not robot.plugged_in:
                raise RobotError(f"cannot open the port {url}: its plug is out")
            robot.bytes_to_send()  # a port that was not open has lost what arrived
        return MemoryPort(robot, clock)

    return open_port


def simulator_of(url: str) -> Simulated:
    """Make the simulated robot that a URL names, with its faults.

    The URL is "sim:NAME?OPTIONS"; "sim:" may be omitted. The options are `seed` and
    `faults.OPTIONS`: "cubeling?drop=0.05&stall=1s/10s&seed=7". Raises RobotError if there is no
    such robot or option, or a value is not allowed.
    """
    name, _, query = url.removeprefix("sim:").partition("?")
    if name not in SIMULATORS:
        known = ", ".join(f"sim:{simulator}" for simulator in SIMULATORS)
        raise RobotError(f"there is no simulated robot {url!r}; there is {known}")
    options: dict[str, str] = {}
    for option, text in parse_qsl(query, keep_blank_values=True):
        if option in options:
            raise RobotError(f"{url!r}: {option} is given twice")
        options[option] = text
    seed_text = options.pop("seed", "0")
    if not re.fullmatch(r"[0-9]{1,18}", seed_text):
        raise RobotError(f"{url!r}: the seed must be a whole number from 0, not {seed_text[:30]!r}")
    seed = int(seed_text)
    faults = faults_of(url, options)
    robot = SIMULATORS[name](seed)
    return robot if faults == Faults() else FaultyRobot(robot, faults, seed)


class MemoryPort:
    """A simulated robot behind pySerial's interface, without a port.

    Every call advances the robot, or raises serial.SerialException after an unplugging.
    """

    def __init__(self, simulator: Simulated, clock: Clock) -> None:
        self.simulator = simulator
        """The robot at the other end."""
        self._clock = clock
        self._arrived = bytearray()
        self._open = True
        self._cancelled = threading.Event()
        self._faulty = simulator if isinstance(simulator, FaultyRobot) else None
        self._unplug_count = self._faulty.unplug_count if self._faulty else 0

    @property
    def in_waiting(self) -> int:
        """Number of bytes that can be read at once."""
        self._advance()
        return len(self._arrived)

    def read(self, size: int = 1, /) -> bytes:
        """Read up to `size` bytes; waits at most `READ_TIMEOUT_S` for the first."""
        self._advance()
        if not self._arrived:
            self._cancelled.wait(READ_TIMEOUT_S)
            self._cancelled.clear()
            self._advance()
        data = bytes(self._arrived[:size])
        del self._arrived[:size]
        return data

    def write(self, data: bytes, /) -> int:
        """Send the bytes to the robot."""
        self._advance()
        self.simulator.receive(data, self._clock())
        return len(data)

    def cancel_read(self) -> None:
        """End a read that waits, as pySerial's does."""
        self._cancelled.set()

    def close(self) -> None:
        """Close the port; the robot no longer advances."""
        self._open = False

    def _advance(self) -> None:
        if not self._open:
            raise serial.PortNotOpenError
        self.simulator.advance(self._clock())
        if self._faulty is not None and self._faulty.unplug_count != self._unplug_count:
            raise serial.SerialException("the plug was pulled")
        self._arrived += self.simulator.bytes_to_send()
