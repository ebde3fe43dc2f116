"""The channel to the robot under test: a port in real time, or a simulation in virtual time."""

from typing import Protocol

import serial

from cubeling.robot.conformance.errors import CheckFailed
from cubeling.robot.contract.port import Clock, Port
from cubeling.robot.errors import RobotError
from cubeling.robot.simulators import Simulated

MAX_READ_BYTES = 4096
"""Most bytes of one read, so that a robot that never pauses does not block the suite."""

STEP_S = 0.001
"""Step of the virtual time [s]."""


class Channel(Protocol):
    """Bytes to and from a robot, and its time."""

    def now(self) -> float:
        """Return the time [s]."""

    def write(self, data: bytes) -> None:
        """Send all of the bytes, or raise after a bounded time."""

    def read(self, until: float) -> bytes:
        """Return bytes as soon as there are any, or none at time `until` [s].

        Every call takes some time, so a robot that never pauses cannot stop the clock.
        """

    def hold_up(self, seconds: float) -> bool:
        """Let time pass in which the robot does not run; return whether that is possible."""


class PortChannel:
    """A port in real time.

    Parameters
    ----------
    port
        An open port; the caller closes it.
    clock
        Returns the time [s].
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
            expected = "a robot that reads its input"
            raise CheckFailed(expected, "it took no bytes for 200 ms") from None
        except OSError as error:
            raise _port_loss(error) from error

    def read(self, until: float) -> bytes:
        """Return bytes as soon as there are any, or none at time `until` [s]."""
        try:
            while self._port.in_waiting or self._clock() < until:
                data = self._port.read(1)
                if data:
                    waiting = min(self._port.in_waiting, MAX_READ_BYTES)
                    return data + self._port.read(waiting) if waiting else data
            return b""
        except OSError as error:  # pySerial's own errors are OSErrors too
            raise _port_loss(error) from error

    def hold_up(self, seconds: float) -> bool:
        """Return False: nobody can keep a real robot from running."""
        return False


class SimulatedChannel:
    """A simulated robot in virtual time.

    Parameters
    ----------
    robot
        The robot at the other end.
    """

    def __init__(self, robot: Simulated) -> None:
        self._robot = robot
        self._now = 1000.0

    def now(self) -> float:
        """Return the time [s]."""
        return self._now

    def write(self, data: bytes) -> None:
        """Pass the bytes to the robot."""
        self._robot.receive(data, self._now)

    def read(self, until: float) -> bytes:
        """Advance the time until the robot sends bytes, or to `until` [s]."""
        while True:
            self._now += STEP_S
            self._robot.advance(self._now)
            data = self._robot.bytes_to_send()
            if data or self._now >= until:
                return data

    def hold_up(self, seconds: float) -> bool:
        """Let time pass in which the robot does not run."""
        self._now += seconds
        return True


def _port_loss(error: OSError) -> RobotError:
    return RobotError(f"the port was lost during the checks ({error}); plug it in again")
