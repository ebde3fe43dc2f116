"""The line to the robot under test: a real port in real time, or a simulated robot in virtual."""

from typing import Protocol

import serial

from robot.conformance.verdicts import UnmetError
from robot.contract.port import Clock, Port
from robot.errors import RobotError
from robot.simulators.base import Simulated

READ_AT_ONCE = 4096
"""Most bytes taken from the line in one go; a babbling robot gets no more of our time."""

STEP = 0.001
"""Virtual time passes in steps of this length [s]."""


class Line(Protocol):
    """Bytes to and from a robot, and the time in which it lives."""

    def now(self) -> float:
        """Return the time [s]."""

    def write(self, data: bytes) -> None:
        """Send all of the bytes, or raise after a bounded time."""

    def read(self, until: float) -> bytes:
        """Return bytes as soon as there are any, or none at time `until` [s].

        Time passes in every call, so that a robot that never pauses does not stop it.
        """


class PortLine:
    """A port in real time.

    Parameters
    ----------
    port
        An open port; whoever opened it closes it.
    clock
        The time [s].
    """

    def __init__(self, port: Port, clock: Clock) -> None:
        self._port = port
        self._clock = clock

    def now(self) -> float:
        """Return the time [s]."""
        return self._clock()

    def write(self, data: bytes) -> None:
        """Send all of the bytes."""
        try:
            self._port.write(data)
        except serial.SerialTimeoutException:
            raise UnmetError("a robot that reads its line", "it took no bytes for 200 ms") from None
        except OSError as error:
            raise _gone(error) from error

    def read(self, until: float) -> bytes:
        """Return bytes as soon as there are any, or none at time `until` [s]."""
        try:
            while self._port.in_waiting or self._clock() < until:
                data = self._port.read(1)
                if data:
                    waiting = min(self._port.in_waiting, READ_AT_ONCE)
                    return data + self._port.read(waiting) if waiting else data
            return b""
        except OSError as error:  # pySerial's own errors are OSErrors too
            raise _gone(error) from error


class SimulatedLine:
    """A simulated robot in virtual time.

    Parameters
    ----------
    robot
        The robot at the far end.
    start
        The time at which it begins [s].
    """

    def __init__(self, robot: Simulated, start: float = 1000.0) -> None:
        self._robot = robot
        self._now = start

    def now(self) -> float:
        """Return the time [s]."""
        return self._now

    def write(self, data: bytes) -> None:
        """Hand the bytes to the robot."""
        self._robot.receive(data, self._now)

    def read(self, until: float) -> bytes:
        """Let time pass until the robot speaks, or until `until` [s]."""
        while True:
            self._now += STEP
            self._robot.advance(self._now)
            data = self._robot.bytes_to_send()
            if data or self._now >= until:
                return data


def _gone(error: OSError) -> RobotError:
    return RobotError(f"the port went away in the middle of the checks ({error}); plug it in again")
