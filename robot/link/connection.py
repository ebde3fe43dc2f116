"""A robot on a port, as the rest of the program uses it."""

import time
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

from affect import Emotion
from robot.contract.catalogue import Catalogue
from robot.contract.closeable import Closeable
from robot.contract.driver import DRIVERS, Driver
from robot.contract.moves import joint_move
from robot.contract.port import Clock
from robot.contract.telemetry import Telemetry
from robot.errors import RobotError
from robot.link.exchange import ByteHook, Direction, IoThread, PortExchange
from robot.link.line_sample import LineSample
from robot.link.transport import opener, spaced
from robot.protocol import messages as m

CATALOGUE_TIMEOUT_S = 10.0
"""Additional time to report its catalogue for a robot that answers over a very lossy line [s]."""


def connect(
    url: str,
    protocol: str | None = None,
    *,
    clock: Clock = time.monotonic,
    on_bytes: ByteHook | None = None,
    answer_within: float | None = None,
    settings: Path | str | None = None,
) -> "Robot":
    """Return the robot on a port, once it has reported its catalogue; the caller closes it.

    Parameters
    ----------
    url
        Any pySerial URL ("/dev/ttyACM0", "COM3", "socket://localhost:5000"), or a simulated robot:
        "sim" (which is "sim:cubeling"), "sim:pleo?seed=7". The protocol may be a prefix:
        "pleo:/dev/ttyACM0".
    protocol
        One of `DRIVERS`; None for the one in the URL, or "cubeling".
    clock
        The time [s] of the link and of a simulated robot.
    on_bytes
        Receives every byte of both directions, in the link's thread. It must be fast.
    answer_within
        How long to wait for the robot [s]; None for the protocol's default. A board that reboots
        when its port is opened needs longer.
    settings
        A TOML file for the driver: the motion of each mood …; None for the bundled one.

    Returns
    -------
    Robot
        Ready for `express`.

    Raises
    ------
    RobotError
        If the port does not open, or nobody on it answers in time. Nothing stays open then.
    """
    url, protocol = protocol_of(url, protocol)
    kind = DRIVERS[protocol]
    # The microsecond of the call tells this program from others.
    host = int(clock() * 1e6) % 0xFFFFFFFF + 1
    driver = kind.make(host, None if settings is None else Path(settings))
    if kind.opener is None or url.startswith("sim:"):
        open_port = opener(url, clock, getattr(driver, "baud", kind.baud))
    else:
        open_port = kind.opener(url, clock)
    if kind.spacing:
        open_port = spaced(open_port, kind.spacing, clock)
    sample = LineSample()

    def observe(direction: Direction, data: bytes, now: float) -> None:
        sample.add(direction, data)
        if on_bytes is not None:
            on_bytes(direction, data, now)

    thread = IoThread(url, open_port, driver, clock, observe)
    robot = Robot(url, thread, driver, clock)
    wait = kind.answer_within if answer_within is None else answer_within
    try:
        if robot.wait_until_ready(wait):
            return robot
        if thread.failure is not None:
            robot.check()
        answers = robot.telemetry.silence is not None
        if answers and robot.wait_until_ready(CATALOGUE_TIMEOUT_S):
            return robot
    except BaseException:  # also Ctrl-C while waiting: nothing stays open then either
        robot.close()
        raise
    robot.close()
    if answers:
        raise RobotError(
            f"the robot on {url} answers, but has not introduced itself within "
            f"{wait + CATALOGUE_TIMEOUT_S:g} s: is the line very bad?"
        )
    raise RobotError(
        f"nobody on {url} answers in the protocol {protocol!r} within {wait:g} s: "
        + sample.diagnosis()
    )


def protocol_of(url: str, protocol: str | None) -> tuple[str, str]:
    """Return the URL of the port without a protocol prefix, and the protocol.

    >>> protocol_of("sim", None), protocol_of("pleo:COM3", None)
    (('sim:cubeling', 'cubeling'), ('COM3', 'pleo'))
    """
    named, colon, rest = url.partition(":")
    if colon and named in DRIVERS:
        if protocol not in (None, named):
            raise RobotError(f"{url!r} is to be spoken to in {protocol!r}: which of the two?")
        url, protocol = rest, named
    if url == "sim":
        url = f"sim:{protocol or 'cubeling'}"
    if protocol is None:
        simulated = url.removeprefix("sim:").partition("?")[0]
        known = url.startswith("sim:") and simulated in DRIVERS
        protocol = simulated if known else "cubeling"
    if protocol not in DRIVERS:
        raise RobotError(f"no robot speaks {protocol!r} here; known are: {', '.join(DRIVERS)}")
    return url, protocol


class Robot(Closeable):
    """A robot on a port. Made by `connect`; close it, or use it in a `with` statement.

    No method waits for the robot: `telemetry.state` is the state of the link, and `check()` raises
    if the robot cannot be reached. After an unplugging or a reboot the link recovers by itself and
    sends the last emotion again.
    """

    def __init__(self, url: str, exchange: PortExchange, driver: Driver, clock: Clock) -> None:
        self.url = url
        """Its port."""
        self._driver, self._clock, self._exchange = driver, clock, exchange
        self._expressed: Emotion | None = None

    def express(self, emotion: Emotion) -> None:
        """Let the robot show an emotion from now on; the latest wins. Never waits, never raises.

        Parameters
        ----------
        emotion
            Valence and arousal, and optionally a word, "happy". Of the robot's own words for its
            moods, the one closest to that word is shown; without a word the robot chooses.
        """
        if self._expressed == emotion:
            return  # every frame of a session asks; only a new emotion is worth waking the link
        with self._exchange.lock:
            self._expressed = emotion
            self._driver.express(emotion)
        self._exchange.wake()

    def play(self, name: str) -> None:
        """Play one of the robot's motions or sounds once.

        It is played at most once and never late: if the link is lost before the robot takes it, it
        is dropped and counted.

        Raises
        ------
        RobotError
            If the robot has nothing of that name, or too many are waiting.
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

    def move(self, angles: Mapping[str, float | None], duration: float = 0.0) -> None:
        """Turn single joints, and hold them there; all others follow mood and motion as before.

        They are held until a later move, `stop`, or the end of the session, and no faster than
        their top speed. A move takes effect at most once, and never late, as in `play`.

        Parameters
        ----------
        angles
            The angle of each joint by name [rad]; None lets go of a joint.
        duration
            Time for the way [s]; 0 for as fast as the joints can.

        Raises
        ------
        RobotError
            If this robot does not turn single joints, an angle or the duration is out of its
            range, or too many moves are waiting.
        """
        catalogue = self.catalogue
        with self._exchange.lock:
            mover = self._driver.joint_mover
            if mover is None:
                raise RobotError(f"the joints of {catalogue.name} cannot be turned one by one")
            taken = mover.move(joint_move(catalogue, angles, duration))
        if not taken:
            raise RobotError("one move too many: the robot has not begun the others yet")
        self._exchange.wake()

    @property
    def moves_joints(self) -> bool:
        """Whether `move` works with this robot."""
        with self._exchange.lock:
            return self._driver.joint_mover is not None

    def stop(self) -> None:
        """End everything, let go of the joints, and hold the neutral pose until another request."""
        with self._exchange.lock:
            self._expressed = None
            self._driver.stop()
        self._exchange.wake()

    @property
    def telemetry(self) -> Telemetry:
        """What is known of the robot now."""
        with self._exchange.lock:
            telemetry = self._driver.telemetry(self._clock())
        discarded = self._exchange.discarded
        if not discarded:
            return telemetry
        return replace(telemetry, counts=replace(telemetry.counts, discarded=discarded))

    @property
    def catalogue(self) -> Catalogue:
        """What the robot has."""
        with self._exchange.lock:
            if self._driver.catalogue is None:
                raise RobotError(f"the robot on {self.url} has not introduced itself yet")
            return self._driver.catalogue

    def check(self) -> None:
        """Raise RobotError if the robot cannot be reached now."""
        failure = self._exchange.failure
        if failure is not None:
            raise RobotError(f"the link to {self.url} broke: {failure!r}") from failure
        telemetry = self.telemetry
        if telemetry.state in ("ready", "degraded"):
            return
        reasons = {"connecting": "has not answered yet", "closed": "was closed"}
        reason = reasons.get(telemetry.state, "has fallen silent")
        silent = "" if telemetry.silence is None else f" (last heard {telemetry.silence:.1f} s ago)"
        raise RobotError(f"the robot on {self.url} {reason}{silent}")

    def wait_until_ready(self, timeout: float) -> bool:
        """Wait at most `timeout` seconds until the link is ready; return whether it is."""
        received, closing = self._exchange.received, self._exchange.closing
        with received:
            return received.wait_for(self._is_decided, timeout) and not closing.is_set()

    def _is_decided(self) -> bool:
        """Return whether the link is ready or has ended."""
        state = self._driver.state(self._clock())
        return self._exchange.closing.is_set() or state in ("ready", "degraded")

    def close(self) -> None:
        """End the session and the thread, and close the port. A second call does nothing."""
        self._exchange.close()
