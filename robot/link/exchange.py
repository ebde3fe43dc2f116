"""Bytes between a port and a driver: one turn reads, lets the driver think, and writes.

Who turns, and how it waits, is another matter: a thread in real time (`robot.link.io_thread`), or
whoever owns a simulated robot, in virtual time (`robot.simulators.stepped`).
"""

import contextlib
import threading
from collections.abc import Callable
from typing import Literal

import serial

from robot.contract.driver import Driver
from robot.contract.port import Clock, Opener, Port
from robot.errors import RobotError
from robot.link.budget import Budget

ByteHook = Callable[[Literal["tx", "rx"], bytes, float], None]
"""Is called by who turns, with a direction, the bytes, and the time [s]."""

REOPEN_EVERY = 0.25
"""A port that is gone is looked for this often [s]."""

READ_AT_ONCE = 1024
"""Most bytes taken from the port in one go."""


class Exchange:
    """Moves bytes between a port and a driver, a turn at a time.

    Parameters
    ----------
    open_port
        Opens the port, now and after an unplugging; the exchange closes it.
    driver
        Who speaks. Whoever else touches it holds `lock`.
    clock
        The time [s].
    on_bytes
        Is given every byte of both directions.
    """

    def __init__(
        self, open_port: Opener, driver: Driver, clock: Clock, on_bytes: ByteHook | None
    ) -> None:
        self.lock = threading.Lock()
        """Guards the driver; never held while the port is waited for."""
        self.heard = threading.Condition(self.lock)
        """Is notified after bytes have been received, and at the end."""
        self.closing = threading.Event()
        """Set when the end has begun."""
        self.failure: Exception | None = None
        """What ended it, if that was not `close`."""
        self.discarded = 0
        """Bytes thrown away unread: the robot said too much."""
        self._open_port = open_port
        self._port: Port | None = open_port()
        self._driver = driver
        self._clock = clock
        self._on_bytes = on_bytes
        self._budget = Budget()
        self._driver.port_opened(clock())

    def wake(self) -> None:
        """End a wait for bytes, if there is one: the driver has been asked for something."""

    def close(self) -> None:
        """Say goodbye and give the port back. A second call does nothing."""
        self.closing.set()
        self._say_goodbye()

    def _turn(self, port: Port, read: Callable[[Port], bytes]) -> bool:
        """Read what is there, let the driver think, write what it says.

        Returns whether the robot has said more than it may: the rest was thrown away, undecoded.
        """
        try:
            data = read(port)
        except OSError:  # pySerial's own errors are OSErrors too: unplugged
            self._unplug(port)
            return False
        now = self._clock()
        granted = self._budget.grant(len(data), now)
        with self.heard:
            self._driver.receive(data[:granted], now)
            self._driver.tick(now)
            answer = self._driver.bytes_to_send()
            if data:
                self.heard.notify_all()
        self._tell("rx", data, now)
        if answer:
            self._write(port, answer)
            self._tell("tx", answer, now)
        self.discarded += len(data) - granted
        return granted < len(data)

    def _write(self, port: Port, data: bytes) -> None:
        try:
            port.write(data)
        except serial.SerialTimeoutException:
            pass  # a robot that does not read its line loses these bytes; its silence will tell
        except OSError:
            self._unplug(port)

    def _tell(self, direction: Literal["tx", "rx"], data: bytes, now: float) -> None:
        if data and self._on_bytes is not None:
            self._on_bytes(direction, data, now)

    def _unplug(self, port: Port) -> None:
        with self.lock:
            self._port = None
            self._driver.port_lost()
        with contextlib.suppress(OSError):
            port.close()

    def _reopen(self) -> bool:
        """Look for a port that was unplugged; whether it is back."""
        try:
            port = self._open_port()
        except RobotError:
            return False
        with self.lock:
            self._port = port
            self._driver.port_opened(self._clock())
        return True

    def _say_goodbye(self) -> None:
        self.closing.set()
        with self.heard:
            self._driver.close()
            farewell = self._driver.bytes_to_send()
            port, self._port = self._port, None
            self.heard.notify_all()
        if port is None:
            return
        with contextlib.suppress(OSError):
            port.write(farewell)
        with contextlib.suppress(OSError):
            port.close()
        if self.failure is None:  # else it may be the hook itself that failed
            self._tell("tx", farewell, self._clock())
