"""The thread between a port and a protocol: the only one of a link, and the only one that waits."""

import contextlib
import threading

from robot.contract.driver import Driver
from robot.contract.port import Clock, Opener, Port
from robot.link.budget import REST
from robot.link.exchange import READ_AT_ONCE, REOPEN_EVERY, ByteHook, Exchange

JOIN_WITHIN = 1.0
"""Longest wait for the thread to end [s]."""

PSEUDO_TERMINALS = ("/dev/pts/", "/dev/ttys")
"""Ports that are not opened again: once gone, the same name may be somebody's shell."""


class Pump(Exchange):
    """Moves bytes in a thread of its own, and finds the port again after an unplugging.

    Parameters
    ----------
    url
        What the port is called.
    open_port, driver, clock, on_bytes
        See `Exchange`.
    """

    def __init__(
        self, url: str, open_port: Opener, driver: Driver, clock: Clock, on_bytes: ByteHook | None
    ) -> None:
        super().__init__(open_port, driver, clock, on_bytes)
        self._url = url
        self._woken = False
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
                    self._look()
                elif self._turn(self._port, self._read):
                    self.closing.wait(REST)
        except Exception as error:
            self.failure = error  # `check` tells it; a thread has nobody else to tell
        finally:
            self._say_goodbye()

    def _look(self) -> None:
        if self._url.startswith(PSEUDO_TERMINALS):
            self.closing.wait()
        elif not self._reopen():
            self.closing.wait(REOPEN_EVERY)

    def _read(self, port: Port) -> bytes:
        """Wait a moment for a byte, then take all that is there."""
        data = port.read(1)
        while data and len(data) < READ_AT_ONCE:
            waiting = port.in_waiting
            if not waiting:
                break
            data += port.read(min(waiting, READ_AT_ONCE - len(data)))
        self._woken = False
        return data
