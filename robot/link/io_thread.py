"""The I/O thread of a link: the only one that waits for the port."""

import contextlib
import threading

from robot.contract.driver import Driver
from robot.contract.port import Clock, Opener, Port
from robot.link.exchange import (
    FLOOD_PAUSE_S,
    MAX_READ_BYTES,
    REOPEN_INTERVAL_S,
    ByteHook,
    PortExchange,
)

JOIN_TIMEOUT_S = 1.0
"""Longest wait for the thread to end [s]."""

PSEUDO_TERMINALS = ("/dev/pts/", "/dev/ttys")
"""Ports that are not opened again: once one is gone, the same name may be a person's shell."""


class IoThread(PortExchange):
    """Moves bytes in its own thread, and reopens the port after an unplugging.

    Parameters
    ----------
    url
        Name of the port.
    open_port, driver, clock, on_bytes
        See `PortExchange`.
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
