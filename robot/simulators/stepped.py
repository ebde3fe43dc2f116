"""A simulated robot in virtual time: its owner advances it; no thread, no wait."""

import math
from pathlib import Path

from cubeling.robot.contract.driver import Driver
from cubeling.robot.contract.port import ByteHook, Clock, Opener, Port
from cubeling.robot.drivers import DRIVERS
from cubeling.robot.errors import RobotError
from cubeling.robot.link.connection import CATALOGUE_TIMEOUT_S, protocol_of
from cubeling.robot.link.exchange import MAX_READ_BYTES, REOPEN_INTERVAL_S, PortExchange
from cubeling.robot.link.linked_robot import Robot
from cubeling.robot.link.transport import opener

STEP_S = 0.005
"""Step of the virtual time [s]; an answer is processed at most this much late."""


class _StepDriver(PortExchange):
    """Moves bytes when `step` is called."""

    def __init__(
        self, open_port: Opener, driver: Driver, clock: Clock, on_bytes: ByteHook | None
    ) -> None:
        super().__init__(open_port, driver, clock, on_bytes)
        self._last_attempt = clock()

    def step(self) -> None:
        """Do one transfer, or try to open the port if it was unplugged."""
        if self.closing.is_set():
            return
        if self._port is not None:
            self._transfer(self._port, _read_available)
        elif self._clock() - self._last_attempt >= REOPEN_INTERVAL_S:
            self._last_attempt = self._clock()
            self._reopen()


def _read_available(port: Port) -> bytes:
    waiting = port.in_waiting
    return port.read(min(waiting, MAX_READ_BYTES)) if waiting else b""


class SteppedRobot(Robot):
    """A simulated robot in virtual time; the same calls give the same bytes.

    It serves sessions that are drawn faster or slower than real time, studies and tests. The caller
    closes it, as any `Robot`.

    Parameters
    ----------
    url
        A simulated robot, with faults if needed: "sim:cubeling?drop=0.05&seed=7".
    on_bytes
        Receives every byte of both directions, with the virtual time [s].
    settings
        A TOML file for the driver; None for the bundled one.

    Raises
    ------
    RobotError
        If the URL names no simulated robot, or the robot does not report its catalogue in the time
        of its protocol.

    Examples
    --------
    >>> from cubeling import robot
    >>> with SteppedRobot("sim:cubeling") as dino:
    ...     dino.express(robot.Emotion(0.8, 0.5))
    ...     dino.advance(3.0)
    ...     dino.telemetry.label
    'happy'
    """

    def __init__(
        self, url: str, *, on_bytes: ByteHook | None = None, settings: Path | None = None
    ) -> None:
        port, protocol = protocol_of(url, None)
        if not port.startswith("sim:"):
            raise RobotError(
                f"{url!r} is no simulated robot, and only those can be stepped: say sim:cubeling"
            )
        kind = DRIVERS[protocol]
        self.now = 0.0
        """The virtual time [s]."""
        driver = kind.make(1, settings)
        self._stepper = _StepDriver(
            opener(port, lambda: self.now), driver, lambda: self.now, on_bytes
        )
        super().__init__(port, self._stepper, driver, lambda: self.now)
        while not self._is_decided():
            if self.now > kind.answer_within + CATALOGUE_TIMEOUT_S:
                self.close()
                raise RobotError(f"the robot on {url} does not introduce itself")
            self.advance(STEP_S)

    def advance(self, seconds: float) -> None:
        """Advance the virtual time.

        Parameters
        ----------
        seconds
            How far, 0 or more [s]; an hour takes about 15 s of real time.

        Raises
        ------
        ValueError
            If it is negative or not finite.
        """
        if not 0 <= seconds < math.inf:  # also refuses NaN
            raise ValueError(f"time goes on by 0 s or more, not by {seconds!r}")
        end = self.now + seconds
        while self.now < end - 1e-9:
            self.now = min(self.now + STEP_S, end)
            self._stepper.step()
