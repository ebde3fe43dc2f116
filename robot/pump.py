"""The thread between a port and a protocol: the only one of a link, and the only one that waits."""

import contextlib
import threading
from collections.abc import Callable
from typing import Literal

import serial

from robot.budget import REST, Budget
from robot.driver import Driver
from robot.errors import RobotError
from robot.port import Clock, Opener, Port

ByteHook = Callable[[Literal["tx", "rx"], bytes, float], None]
"""Is called from the link's thread with a direction, the bytes, and the time [s]."""

REOPEN_EVERY = 0.25
"""A port that is gone is looked for this often [s]."""

READ_AT_ONCE = 1024
"""Most bytes taken from the port in one go."""

READS_THROWN_AWAY = 16
"""Most reads whose bytes are dropped in one go. pySerial's own way to empty a buffer never ends on
a socket that babbles (`test_a_line_that_babbles_is_given_up_in_time_and_stops_nobody`)."""

JOIN_WITHIN = 1.0
"""Longest wait for the thread to end [s]."""

PSEUDO_TERMINALS = ("/dev/pts/", "/dev/ttys")
"""Ports that are not opened again: once gone, the same name may be somebody's shell."""


class Pump:
    """Moves bytes between a port and a driver, and finds the port again after an unplugging.

    Parameters
    ----------
    url
        What the port is called.
    open_port
        Opens the port, now and after an unplugging; the pump closes it.
    driver
        Who speaks. Whoever else touches it holds `lock`.
    clock
        The time [s].
    on_bytes
        Is given every byte of both directions.
    """

    def __init__(
        self, url: str, open_port: Opener, driver: Driver, clock: Clock, on_bytes: ByteHook | None
    ) -> None:
        self.lock = threading.Lock()
        """Guards the driver; never held while the port is waited for."""
        self.heard = threading.Condition(self.lock)
        """Is notified after bytes have been received, and at the end."""
        self.closing = threading.Event()
        """Set when the end has begun."""
        self.failure: Exception | None = None
        """What ended the thread, if that was not `close`."""
        self._url = url
        self._open_port = open_port
        self._port: Port | None = open_port()
        self._driver = driver
        self._clock = clock
        self._on_bytes = on_bytes
        self.discarded = 0
        """Bytes thrown away unread: the robot said too much."""
        self._budget = Budget()
        self._woken = False
        self._driver.port_opened(clock())
        self._thread = threading.Thread(target=self._run, name=f"robot {url}", daemon=True)
        self._thread.start()

    def wake(self) -> None:
        """End the read that waits, where the port can; elsewhere it ends by itself very soon."""
        with self.lock:  # so that the port is not closed meanwhile
            cancel = getattr(self._port, "cancel_read", None)
            if cancel is not None and not self._woken:
                self._woken = True
                with contextlib.suppress(OSError):  # it notices at its next read
                    cancel()

    def close(self) -> None:
        """Say goodbye, end the thread and give the port back."""
        self.closing.set()
        self.wake()
        if threading.current_thread() is not self._thread:
            self._thread.join(JOIN_WITHIN)

    def _run(self) -> None:
        try:
            while not self.closing.is_set():
                if self._port is None:
                    self._reopen()
                else:
                    self._pump(self._port)
        except Exception as error:
            self.failure = error  # `check` tells it; a thread has nobody else to tell
        finally:
            self._say_goodbye()

    def _pump(self, port: Port) -> None:
        """Read what is there, let the driver think, write what it says."""
        try:
            data = _read(port)
        except OSError:  # pySerial's own errors are OSErrors too: unplugged
            self._unplug(port)
            return
        now = self._clock()
        with self.heard:
            self._woken = False
            self._driver.receive(data, now)
            self._driver.tick(now)
            answer = self._driver.bytes_to_send()
            if data:
                self.heard.notify_all()
        self._tell("rx", data, now)
        if answer:
            self._write(port, answer)
            self._tell("tx", answer, now)
        if self._budget.spend(len(data), now):
            self._throw_away(port)
            self.closing.wait(REST)

    def _throw_away(self, port: Port) -> None:
        """Drop what a babbling robot has sent beyond its budget, undecoded."""
        try:
            for _ in range(READS_THROWN_AWAY):
                if not port.in_waiting:
                    break
                self.discarded += len(port.read(READ_AT_ONCE))
        except OSError:
            self._unplug(port)

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

    def _reopen(self) -> None:
        if self._url.startswith(PSEUDO_TERMINALS):
            self.closing.wait()
            return
        try:
            port = self._open_port()
        except RobotError:
            self.closing.wait(REOPEN_EVERY)
            return
        with self.lock:
            self._port = port
            self._driver.port_opened(self._clock())

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


def _read(port: Port) -> bytes:
    """Wait a moment for a byte, then take all that is there."""
    data = port.read(1)
    while data and len(data) < READ_AT_ONCE:
        waiting = port.in_waiting
        if not waiting:
            break
        data += port.read(min(waiting, READ_AT_ONCE - len(data)))
    return data
