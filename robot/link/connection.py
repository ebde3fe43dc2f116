"""A robot on a port: what the rest of the program talks to."""

import time
from dataclasses import replace
from pathlib import Path

from affect.emotion import Emotion
from robot.contract.catalogue import Catalogue
from robot.contract.closing import Closing
from robot.contract.driver import DRIVERS, Driver
from robot.contract.port import Clock
from robot.contract.telemetry import Telemetry
from robot.errors import RobotError
from robot.link.exchange import ByteHook, Exchange
from robot.link.io_thread import Pump
from robot.link.spacing import spaced
from robot.link.transport import opener
from robot.protocol import messages as m

INTRODUCTION = 10.0
"""A robot that answers, over a line that loses much, has so long to introduce itself [s]."""


def connect(
    url: str,
    protocol: str | None = None,
    *,
    clock: Clock = time.monotonic,
    on_bytes: ByteHook | None = None,
    answer_within: float | None = None,
    settings: Path | str | None = None,
) -> "Robot":
    """Open a port and wait until the robot on it has introduced itself.

    Parameters
    ----------
    url
        Any pySerial URL ("/dev/ttyACM0", "COM3", "socket://localhost:5000"), or a simulated robot:
        "sim:cubeling", "sim:pleo?seed=7". The protocol may stand in front: "pleo:/dev/ttyACM0".
    protocol
        What the robot speaks, one of `DRIVERS`; None for what the URL says, or "cubeling".
    clock
        The time [s] by which the link, and a simulated robot, live.
    on_bytes
        Is given every byte of both directions, from the link's thread. It must be quick.
    answer_within
        How long to wait for the robot [s]; None for the protocol's own time. A board that reboots
        when its port is opened needs more.
    settings
        A TOML file for the driver: which motion stands for which mood …; None for its own.

    Returns
    -------
    Robot
        Ready for `express`. Whoever called this closes it.

    Raises
    ------
    RobotError
        If the port does not open, or nobody on it answers in time. Nothing is left open then.
    """
    url, protocol = protocol_of(url, protocol)
    kind = DRIVERS[protocol]
    # So that two programs are not taken for one: the microsecond in which this one connects.
    host = int(clock() * 1e6) % 0xFFFFFFFF + 1
    driver = kind.make(host, None if settings is None else Path(settings))
    if kind.opener is None or url.startswith("sim:"):
        open_port = opener(url, clock, getattr(driver, "baud", kind.baud))
    else:
        open_port = kind.opener(url, clock)
    if kind.spacing:
        open_port = spaced(open_port, kind.spacing, clock)
    robot = Robot(url, Pump(url, open_port, driver, clock, on_bytes), driver, clock)
    wait = kind.answer_within if answer_within is None else answer_within
    try:
        if robot.wait_until_ready(wait):
            return robot
        if robot.failed:
            robot.check()
        answers = robot.telemetry.silence is not None
        if answers and robot.wait_until_ready(INTRODUCTION):
            return robot
    except BaseException:  # also Ctrl-C while waiting: nothing is left open then either
        robot.close()
        raise
    robot.close()
    if answers:
        raise RobotError(
            f"the robot on {url} answers, but has not introduced itself within "
            f"{wait + INTRODUCTION:g} s: is the line very bad?"
        )
    raise RobotError(
        f"nobody on {url} answers in the protocol {protocol!r} within {wait:g} s: "
        "is the robot switched on, and is this its port?"
    )


def protocol_of(url: str, protocol: str | None) -> tuple[str, str]:
    """Return the port's own URL, and the protocol that is spoken there."""
    named, colon, rest = url.partition(":")
    if colon and named in DRIVERS:
        if protocol not in (None, named):
            raise RobotError(f"{url!r} is to be spoken to in {protocol!r}: which of the two?")
        url, protocol = rest, named
    if protocol is None:
        simulated = url.removeprefix("sim:").partition("?")[0]
        known = url.startswith("sim:") and simulated in DRIVERS
        protocol = simulated if known else "cubeling"
    if protocol not in DRIVERS:
        raise RobotError(f"no robot speaks {protocol!r} here; known are: {', '.join(DRIVERS)}")
    return url, protocol


class Robot(Closing):
    """A robot on a port. Made by `connect`; close it, or use it in a `with` statement.

    No method waits for the robot, and a robot that dies stops nobody: `telemetry.state` says how
    the link is, and `check()` raises if it is not well. After an unplugging or a reboot the link
    comes back by itself and restates the last emotion.
    """

    def __init__(
        self,
        url: str,
        exchange: Exchange,
        driver: Driver,
        clock: Clock,
    ) -> None:
        self.url = url
        """The port it is on."""
        self._driver = driver
        self._clock = clock
        self._exchange = exchange
        self._wish: tuple[Emotion, str | None] | None = None

    # --- What to do ----------------------------------------------------------------------------

    def express(self, emotion: Emotion, label: str | None = None) -> None:
        """Let the robot feel this from now on; the latest wins. Never waits and never raises.

        Parameters
        ----------
        emotion
            Where in the plane of valence and arousal.
        label
            The mood's word, "happy", so that the robot shows the same as everyone else; the one of
            its own words that is closest is taken. None: the robot chooses.
        """
        if self._wish == (emotion, label):
            return  # every frame of a session asks; only a new wish is worth waking the link
        with self._exchange.lock:
            self._wish = emotion, label
            self._driver.express(emotion, label)
        self._exchange.wake()

    def play(self, name: str) -> None:
        """Let the robot play one of its motions or sounds once.

        It is taken at most once, and not late: if the link is lost now or before the robot takes
        it, it is dropped and counted.

        Raises
        ------
        RobotError
            If the robot has nothing of that name, or too many wait already.
        """
        catalogue = self.catalogue
        if name in catalogue.motions:
            item, index = m.ITEM_MOTION, catalogue.motions.index(name)
        elif name in catalogue.sounds:
            item, index = m.ITEM_SOUND, catalogue.sounds.index(name)
        else:
            known = ", ".join(catalogue.motions + catalogue.sounds)
            raise RobotError(f"{catalogue.name} cannot play {name!r}; it knows {known}")
        with self._exchange.lock:
            taken = self._driver.play(item, index)
        if not taken:
            raise RobotError(f"{name!r} is one too many: the robot has not played the others yet")
        self._exchange.wake()

    def stop(self) -> None:
        """Let the robot end everything and hold its neutral pose, until it is asked for more."""
        with self._exchange.lock:
            self._wish = None
            self._driver.stop()
        self._exchange.wake()

    # --- How it is -----------------------------------------------------------------------------

    @property
    def telemetry(self) -> Telemetry:
        """What is known now."""
        with self._exchange.lock:
            known = self._driver.telemetry(self._clock())
        discarded = self._exchange.discarded
        if not discarded:
            return known
        return replace(known, counts=replace(known.counts, discarded=discarded))

    @property
    def catalogue(self) -> Catalogue:
        """What the robot has."""
        with self._exchange.lock:
            if self._driver.catalogue is None:
                raise RobotError(f"the robot on {self.url} has not introduced itself yet")
            return self._driver.catalogue

    def check(self) -> None:
        """Raise RobotError, in one line, if the robot cannot be reached now."""
        failure = self._exchange.failure
        if failure is not None:
            raise RobotError(f"the link to {self.url} broke: {failure!r}") from failure
        telemetry = self.telemetry
        if telemetry.state in ("ready", "degraded"):
            return
        reason = {
            "connecting": "has not answered yet",
            "closed": "was closed",
        }.get(telemetry.state, "has fallen silent")
        silent = "" if telemetry.silence is None else f" (last heard {telemetry.silence:.1f} s ago)"
        raise RobotError(f"the robot on {self.url} {reason}{silent}")

    @property
    def failed(self) -> bool:
        """Whether the link's thread has broken down; `check` says why."""
        return self._exchange.failure is not None

    def wait_until_ready(self, timeout: float) -> bool:
        """Wait until the link is ready, for at most `timeout` seconds; whether it is."""
        heard, closing = self._exchange.heard, self._exchange.closing
        with heard:
            return heard.wait_for(self._is_settled, timeout) and not closing.is_set()

    def _is_settled(self) -> bool:
        state = self._driver.state(self._clock())
        return self._exchange.closing.is_set() or state in ("ready", "degraded")

    # --- The end -------------------------------------------------------------------------------

    def close(self) -> None:
        """Say goodbye, end the thread and give the port back. A second call does nothing."""
        self._exchange.close()
