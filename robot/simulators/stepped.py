"""A simulated robot in step with whoever owns it: virtual time, no thread and no wait."""

import math
from pathlib import Path

from robot.contract.driver import Driver
from robot.contract.port import Clock, Opener, Port
from robot.drivers import DRIVERS
from robot.errors import RobotError
from robot.link.connection import INTRODUCTION, Robot, protocol_of
from robot.link.exchange import READ_AT_ONCE, REOPEN_EVERY, ByteHook, Exchange
from robot.link.transport import opener

STEP = 0.005
"""Time goes on in steps of this length [s]: how late an answer may be noticed."""


class _Crank(Exchange):
    """Moves bytes when it is told."""

    def __init__(
        self, open_port: Opener, driver: Driver, clock: Clock, on_bytes: ByteHook | None
    ) -> None:
        super().__init__(open_port, driver, clock, on_bytes)
        self._looked = clock()

    def turn(self) -> None:
        """Do one exchange, or look for the port if it was unplugged."""
        if self.closing.is_set():
            return
        if self._port is not None:
            self._turn(self._port, _read_what_is_there)
        elif self._clock() - self._looked >= REOPEN_EVERY:
            self._looked = self._clock()
            self._reopen()


def _read_what_is_there(port: Port) -> bytes:
    waiting = port.in_waiting
    return port.read(min(waiting, READ_AT_ONCE)) if waiting else b""


class SteppedRobot(Robot):
    """A simulated robot whose time is told; the same calls give the same bytes.

    For sessions that are drawn faster or slower than life, for studies, for tests: a thread would
    live by the wall's clock. Whoever makes it closes it, as any `Robot`.

    Parameters
    ----------
    url
        "sim:NAME", with faults if need be: "sim:cubeling?drop=0.05&seed=7".
    on_bytes
        Is given every byte of both directions, with this robot's own time.
    settings
        A TOML file for the driver, or None.

    Raises
    ------
    RobotError
        If the URL names no simulated robot, or it does not introduce itself in the time that its
        protocol allows.

    Examples
    --------
    >>> import robot
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
                f"{url!r} is no simulated robot, whose time could be told: say sim:cubeling"
            )
        kind = DRIVERS[protocol]
        self.now = 0.0
        """Its time [s]."""
        driver = kind.make(1, settings)
        self._crank = _Crank(opener(port, lambda: self.now), driver, lambda: self.now, on_bytes)
        super().__init__(port, self._crank, driver, lambda: self.now)
        while not self._is_settled():
            if self.now > kind.answer_within + INTRODUCTION:
                self.close()
                raise RobotError(f"the robot on {url} does not introduce itself")
            self.advance(STEP)

    def advance(self, seconds: float) -> None:
        """Let time go on.

        Parameters
        ----------
        seconds
            How long, 0 or more [s]; an hour of it takes some 15 s of real time.

        Raises
        ------
        ValueError
            If that is no time, or has no end.
        """
        if not 0 <= seconds < math.inf:  # also refuses NaN
            raise ValueError(f"time goes on by 0 s or more, not by {seconds!r}")
        end = self.now + seconds
        while self.now < end - 1e-9:
            self.now = min(self.now + STEP, end)
            self._crank.turn()
