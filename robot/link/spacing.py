"""A port that leaves time between writes, for robots that read all that has come as one line."""

import threading
from typing import Any

from robot.contract.port import Clock, Opener, Port


class SpacedPort:
    """A port whose writes keep their distance; everything else goes straight through.

    A driver that keeps its own rate never waits here. Only its goodbye does, where it follows on
    the heels of a command.

    Parameters
    ----------
    port
        The port.
    spacing
        Least time between two writes, and so the longest wait in one [s].
    clock
        The time [s].
    """

    def __init__(self, port: Port, spacing: float, clock: Clock) -> None:
        self._port, self._spacing, self._clock = port, spacing, clock
        self._written: float | None = None

    def __getattr__(self, name: str) -> Any:
        return getattr(self._port, name)

    @property
    def in_waiting(self) -> int:
        """Bytes that can be read at once."""
        return self._port.in_waiting

    def read(self, size: int = 1, /) -> bytes:
        """Read up to `size` bytes, waiting a bounded time for them."""
        return self._port.read(size)

    def write(self, data: bytes, /) -> int | None:
        """Write all of the bytes, after a wait if the last ones were written just now."""
        if data and self._written is not None:
            left = self._spacing - (self._clock() - self._written)
            if left > 0:
                threading.Event().wait(min(left, self._spacing))
        written = self._port.write(data)
        if data:
            self._written = self._clock()
        return written

    def close(self) -> None:
        """Give the port back."""
        self._port.close()


def spaced(open_port: Opener, spacing: float, clock: Clock) -> Opener:
    """Return what opens the same port with `spacing` [s] between its writes."""
    return lambda: SpacedPort(open_port(), spacing, clock)
