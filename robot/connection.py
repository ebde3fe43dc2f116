"""A robot on a port: the only thread of this room, and what the rest of the program talks to."""

import contextlib
import threading
import time
from collections.abc import Callable
from types import TracebackType
from typing import Literal, Protocol, Self

import serial

from robot import messages as m
from robot.catalogue import Catalogue
from robot.emotion import Emotion
from robot.errors import RobotError
from robot.host import HostLink
from robot.telemetry import LinkState, Telemetry
from robot.transport import Clock, Port, open_port

ByteHook = Callable[[Literal["tx", "rx"], bytes, float], None]
"""Is called from the link's thread with a direction, the bytes, and the time [s]."""

ANSWER_WITHIN = 2.0
"""A robot that has not introduced itself after this long is taken for none [s]."""

REOPEN_EVERY = 0.25
"""A port that is gone is looked for this often [s]."""

READ_AT_ONCE = 4096
"""Most bytes taken from the port in one go; a babbling robot gets no more of our time."""

JOIN_WITHIN = 1.0
"""Longest wait for the thread to end [s]."""


class Driver(Protocol):
    """A protocol's host end, without clock, thread or port; `HostLink` is one."""

    catalogue: Catalogue | None
    """What the robot has; None until it is known."""

    def express(self, emotion: Emotion) -> None:
        """Ask for an emotion; only the latest counts."""

    def play(self, item: int, index: int) -> bool:
        """Ask for a motion or a sound once; False if too many wait."""

    def stop(self) -> None:
        """Ask for the neutral pose."""

    def port_opened(self, now: float) -> None:
        """Begin, or begin again."""

    def port_lost(self) -> None:
        """Send nothing until the port is back."""

    def close(self) -> None:
        """Say goodbye."""

    def receive(self, data: bytes, now: float) -> None:
        """Take bytes from the line."""

    def tick(self, now: float) -> None:
        """Do what is due."""

    def bytes_to_send(self) -> bytes:
        """Return what is to be written, once."""

    def state(self, now: float) -> LinkState:
        """Return the state of the link."""

    def telemetry(self, now: float) -> Telemetry:
        """Return all that is known."""


DRIVERS: dict[str, Callable[[int], Driver]] = {"cubeling": HostLink}
"""The protocols by name; a driver is made from a number that tells this program from others."""


def connect(
    url: str,
    protocol: str = "cubeling",
    *,
    clock: Clock = time.monotonic,
    on_bytes: ByteHook | None = None,
    answer_within: float = ANSWER_WITHIN,
) -> "Robot":
    """Open a port and wait until the robot on it has introduced itself.

    Parameters
    ----------
    url
        Any pySerial URL ("/dev/ttyACM0", "COM3", "socket://localhost:5000"), or a simulated robot:
        "sim:cubeling", "sim:cubeling?seed=7".
    protocol
        What the robot speaks.
    clock
        The time [s] by which the link, and a simulated robot, live.
    on_bytes
        Is given every byte of both directions, from the link's thread. It must be quick.
    answer_within
        How long to wait for the robot [s]. A board that reboots when its port is opened needs more.

    Returns
    -------
    Robot
        Ready for `express`. Whoever called this closes it.

    Raises
    ------
    RobotError
        If the port does not open, or nobody on it answers in time. Nothing is left open then.
    """
    if protocol not in DRIVERS:
        raise RobotError(f"no robot speaks {protocol!r} here; known are: {', '.join(DRIVERS)}")
    port = open_port(url, clock)
    # Two programs must not be taken for one; the clock is as good a source as any, and seeded.
    host = int(clock() * 1e6) % 0xFFFFFFFF + 1
    robot = Robot(url, port, DRIVERS[protocol](host), clock, on_bytes)
    try:
        ready = robot.wait_until_ready(answer_within)
    except BaseException:  # Ctrl-C while waiting: nothing is left open then either
        robot.close()
        raise
    if not ready:
        robot.close()
        raise RobotError(
            f"nobody on {url} answers in the protocol {protocol!r} within {answer_within:g} s: "
            "is the robot switched on, and is this its port?"
        )
    return robot


class Robot:
    """A robot on a port. Made by `connect`; close it, or use it in a `with` statement.

    No method waits for the robot, and a robot that dies stops nobody: `telemetry.state` says how
    the link is, and `check()` raises if it is not well. After an unplugging or a reboot the link
    comes back by itself and restates the last emotion.
    """

    def __init__(
        self,
        url: str,
        port: Port,
        driver: Driver,
        clock: Clock,
        on_bytes: ByteHook | None,
    ) -> None:
        self.url = url
        """The port it is on."""
        self._port: Port | None = port
        self._driver = driver
        self._clock = clock
        self._on_bytes = on_bytes
        self._lock = threading.Lock()  # guards the driver; never held while the port is waited for
        self._ready = threading.Condition(self._lock)
        self._closing = threading.Event()
        self._failure: Exception | None = None
        self._driver.port_opened(clock())
        self._thread = threading.Thread(target=self._run, name=f"robot {url}", daemon=True)
        self._thread.start()

    # --- What to do ----------------------------------------------------------------------------

    def express(self, emotion: Emotion) -> None:
        """Let the robot feel this from now on; the latest wins. Never waits and never raises."""
        with self._lock:
            self._driver.express(emotion)
        self._wake()

    def play(self, name: str) -> None:
        """Let the robot play one of its motions or sounds once.

        It is sent at most once: if the link is lost before the robot takes it, it is dropped.

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
        with self._lock:
            taken = self._driver.play(item, index)
        if not taken:
            raise RobotError(f"{name!r} is one too many: the robot has not played the others yet")
        self._wake()

    def stop(self) -> None:
        """Let the robot end everything and hold its neutral pose, until it is asked for more."""
        with self._lock:
            self._driver.stop()
        self._wake()

    # --- How it is -----------------------------------------------------------------------------

    @property
    def telemetry(self) -> Telemetry:
        """What is known now."""
        with self._lock:
            return self._driver.telemetry(self._clock())

    @property
    def catalogue(self) -> Catalogue:
        """What the robot has."""
        with self._lock:
            if self._driver.catalogue is None:
                raise RobotError(f"the robot on {self.url} has not introduced itself yet")
            return self._driver.catalogue

    def check(self) -> None:
        """Raise RobotError, in one line, if the robot cannot be reached now."""
        if self._failure is not None:
            raise RobotError(f"the link to {self.url} broke: {self._failure}") from self._failure
        telemetry = self.telemetry
        if telemetry.state in ("ready", "degraded"):
            return
        reason = {
            "connecting": "has not answered yet",
            "closed": "was closed",
        }.get(telemetry.state, "has fallen silent")
        silent = "" if telemetry.silence is None else f" (last heard {telemetry.silence:.1f} s ago)"
        raise RobotError(f"the robot on {self.url} {reason}{silent}")

    def wait_until_ready(self, timeout: float) -> bool:
        """Wait until the link is ready, for at most `timeout` seconds; whether it is."""
        with self._ready:
            return self._ready.wait_for(self._is_settled, timeout) and not self._closing.is_set()

    def _is_settled(self) -> bool:
        return self._closing.is_set() or self._driver.state(self._clock()) in ("ready", "degraded")

    # --- The end -------------------------------------------------------------------------------

    def close(self) -> None:
        """Say goodbye, end the thread and give the port back. A second call does nothing."""
        self._closing.set()
        self._wake()
        if threading.current_thread() is not self._thread:
            self._thread.join(JOIN_WITHIN)

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.close()

    # --- The thread ----------------------------------------------------------------------------

    def _run(self) -> None:
        try:
            while not self._closing.is_set():
                if self._port is None:
                    self._reopen()
                else:
                    self._pump(self._port)
        except Exception as error:
            self._failure = error  # `check` tells it; a thread has nobody else to tell
        finally:
            self._say_goodbye()

    def _pump(self, port: Port) -> None:
        """Read what is there, let the driver think, write what it says."""
        try:
            data = _read(port)
            now = self._clock()
            with self._ready:
                self._driver.receive(data, now)
                self._driver.tick(now)
                answer = self._driver.bytes_to_send()
                if data:
                    self._ready.notify_all()
            self._tell("rx", data, now)
            self._write(port, answer, now)
        except OSError:  # pySerial's own errors too: unplugged
            self._unplug(port)

    def _write(self, port: Port, data: bytes, now: float) -> None:
        if not data:
            return
        # A robot that does not read its line loses these bytes; its silence will tell.
        with contextlib.suppress(serial.SerialTimeoutException):
            port.write(data)
        self._tell("tx", data, now)

    def _tell(self, direction: Literal["tx", "rx"], data: bytes, now: float) -> None:
        if data and self._on_bytes is not None:
            self._on_bytes(direction, data, now)

    def _unplug(self, port: Port) -> None:
        self._port = None
        with self._lock:
            self._driver.port_lost()
        with contextlib.suppress(OSError):
            port.close()

    def _reopen(self) -> None:
        try:
            self._port = open_port(self.url, self._clock)
        except RobotError:
            self._closing.wait(REOPEN_EVERY)
            return
        with self._lock:
            self._driver.port_opened(self._clock())

    def _say_goodbye(self) -> None:
        self._closing.set()
        with self._ready:
            self._driver.close()
            farewell = self._driver.bytes_to_send()
            self._ready.notify_all()
        port, self._port = self._port, None
        if port is None:
            return
        with contextlib.suppress(OSError):
            port.write(farewell)
            self._tell("tx", farewell, self._clock())
        with contextlib.suppress(OSError):
            port.close()

    def _wake(self) -> None:
        """End the read that waits, where the port can; elsewhere it ends by itself very soon."""
        cancel = getattr(self._port, "cancel_read", None)
        if cancel is not None:
            with contextlib.suppress(OSError, TypeError):  # closed meanwhile, or already woken
                cancel()


def _read(port: Port) -> bytes:
    """Wait a moment for a byte, then take all that is there."""
    data = port.read(1)
    while data and len(data) < READ_AT_ONCE:
        waiting = port.in_waiting
        if not waiting:
            break
        data += port.read(min(waiting, READ_AT_ONCE - len(data)))
    return data
