"""Moves bytes between a port and a driver, within a rate limit, in a thread of its own.

`cubeling.robot.simulators.stepped` does so in virtual time.
"""

import contextlib
import threading
from collections.abc import Callable

import serial

from cubeling.robot.contract.driver import Driver
from cubeling.robot.contract.port import ByteHook, Clock, Direction, Opener, Port
from cubeling.robot.errors import RobotError

REOPEN_INTERVAL_S = 0.25
"""Time between two attempts to open a port that is gone [s]."""

MAX_READ_BYTES = 1024
"""Most bytes that one transfer reads."""

MAX_BYTES_PER_S = 12_000
"""Long-term limit of what is decoded [bytes/s]: 115200 baud. Noise keeps no core busy."""

MAX_BURST_BYTES = 16_000
"""Bytes that may arrive at once: what is waiting after this computer has slept for seconds."""

FLOOD_PAUSE_S = 0.020
"""Pause after the limit was exceeded [s]. It is less than half a beat, so that beats stay in time;
and a flood that fills the system's buffers, some 64 kB, is read within two seconds."""

JOIN_TIMEOUT_S = 1.0
"""Longest wait for the thread to end [s]."""

PSEUDO_TERMINALS = ("/dev/pts/", "/dev/ttys")
"""Ports that are not opened again: once one is gone, the same name may be a person's shell."""


class TokenBucket:
    """Limits received bytes to `MAX_BYTES_PER_S` and `MAX_BURST_BYTES`."""

    def __init__(self) -> None:
        self._tokens = float(MAX_BURST_BYTES)
        self._last: float | None = None

    def grant(self, count: int, now: float) -> int:
        """Return how many of `count` bytes that arrived at `now` [s] are within the limit."""
        elapsed = 0.0 if self._last is None else max(0.0, now - self._last)
        self._last = now
        self._tokens = min(self._tokens + MAX_BYTES_PER_S * elapsed, MAX_BURST_BYTES)
        granted = min(count, int(self._tokens))
        self._tokens -= granted
        return granted


class PortExchange:
    """Moves bytes between a port and a driver, one transfer at a time.

    It closes the port that `open_port` opens. Others use the driver only while they hold `lock`;
    `on_bytes` receives every byte of both directions.
    """

    def __init__(
        self, open_port: Opener, driver: Driver, clock: Clock, on_bytes: ByteHook | None
    ) -> None:
        self.lock = threading.Lock()
        """Guards the driver; never held during a wait for the port."""
        self.received = threading.Condition(self.lock)
        """Notified after bytes have been received, and at the end."""
        self.closing = threading.Event()
        """Set when the end has begun."""
        self.failure: Exception | None = None
        """The error that ended it, if any."""
        self.discarded = 0
        """Received bytes beyond the rate limit."""
        self._open_port = open_port
        self._port: Port | None = open_port()
        self._driver = driver
        self._clock = clock
        self._on_bytes = on_bytes
        self._bucket = TokenBucket()
        self._driver.port_opened(clock())

    def wake(self) -> None:
        """End a wait for bytes, if there is one: the driver has a new request."""

    def close(self) -> None:
        """End the session and close the port. A second call does nothing."""
        self._shut_down()

    def _transfer(self, port: Port, read: Callable[[Port], bytes]) -> bool:
        """Read what has arrived, let the driver process it, and write what it sends.

        Returns whether the robot exceeded the rate limit; the excess was discarded.
        """
        try:
            data = read(port)
        except OSError:  # pySerial's own errors are OSErrors too: unplugged
            self._drop_port(port)
            return False
        now = self._clock()
        granted = self._bucket.grant(len(data), now)
        with self.received:
            self._driver.receive(data[:granted], now)
            self._driver.tick(now)
            answer = self._driver.bytes_to_send()
            if data:
                self.received.notify_all()
        self._report("rx", data, now)
        if answer:
            self._write(port, answer)
            self._report("tx", answer, now)
        self.discarded += len(data) - granted
        return granted < len(data)

    def _write(self, port: Port, data: bytes) -> None:
        try:
            port.write(data)
        except serial.SerialTimeoutException:
            pass  # a robot that does not read its line loses these bytes; its silence shows it
        except OSError:
            self._drop_port(port)

    def _report(self, direction: Direction, data: bytes, now: float) -> None:
        if data and self._on_bytes is not None:
            self._on_bytes(direction, data, now)

    def _drop_port(self, port: Port) -> None:
        with self.lock:
            self._port = None
            self._driver.port_lost()
        with contextlib.suppress(OSError):
            port.close()

    def _reopen(self) -> bool:
        """Try to open a port that was unplugged; return whether it is back."""
        try:
            port = self._open_port()
        except RobotError:
            return False
        with self.lock:
            self._port = port
            self._driver.port_opened(self._clock())
        return True

    def _shut_down(self) -> None:
        self.closing.set()
        with self.received:
            self._driver.close()
            farewell = self._driver.bytes_to_send()
            port, self._port = self._port, None
            self.received.notify_all()
        if port is None:
            return
        with contextlib.suppress(OSError):
            port.write(farewell)
        with contextlib.suppress(OSError):
            port.close()
        if self.failure is None:  # otherwise the hook itself may have failed
            self._report("tx", farewell, self._clock())


class IoThread(PortExchange):
    """Moves bytes in its own thread, the only one that waits for the port, and reopens the port."""

    def __init__(
        self, url: str, open_port: Opener, driver: Driver, clock: Clock, on_bytes: ByteHook | None
    ) -> None:
        super().__init__(open_port, driver, clock, on_bytes)
        self._url = url
        self._woken = False
        self._thread = threading.Thread(target=self._run, name=f"robot {url}", daemon=True)
        self._thread.start()

    def wake(self) -> None:
        """Cancel the read in progress where the port can; elsewhere it ends very soon by itself."""
        with self.lock:  # so that the port is not closed meanwhile
            cancel = getattr(self._port, "cancel_read", None)
            if cancel is not None and not self._woken:
                self._woken = True
                with contextlib.suppress(OSError):  # the next read reports it
                    cancel()

    def close(self) -> None:
        """End the session and the thread, and close the port."""
        self.closing.set()
        self.wake()
        if threading.current_thread() is not self._thread:
            self._thread.join(JOIN_TIMEOUT_S)

    def _run(self) -> None:
        try:
            while not self.closing.is_set():
                if self._port is None:
                    self._wait_for_port()
                elif self._transfer(self._port, self._read):
                    self.closing.wait(FLOOD_PAUSE_S)
        except Exception as error:
            self.failure = error  # `Robot.check` raises it
        finally:
            self._shut_down()

    def _wait_for_port(self) -> None:
        if self._url.startswith(PSEUDO_TERMINALS):
            self.closing.wait()
        elif not self._reopen():
            self.closing.wait(REOPEN_INTERVAL_S)

    def _read(self, port: Port) -> bytes:
        """Wait briefly for a byte, then read everything that has arrived."""
        data = port.read(1)
        while data and len(data) < MAX_READ_BYTES:
            waiting = port.in_waiting
            if not waiting:
                break
            data += port.read(min(waiting, MAX_READ_BYTES - len(data)))
        self._woken = False
        return data
