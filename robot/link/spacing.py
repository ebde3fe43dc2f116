"""A port that keeps time between writes, for robots that read everything waiting as one line."""

import threading
from typing import Any, cast

from robot.contract.port import Clock, Opener, Port


class SpacedPort:
    """A port with a minimum time between writes; everything else is the port's own.

    A driver with its own rate limit never waits here. Only its last bytes do, when they follow a
    command closely.
    """

    def __init__(self, port: Port, spacing: float, clock: Clock) -> None:
        self._port, self._spacing, self._clock = port, spacing, clock
        self._written: float | None = None

    def __getattr__(self, name: str) -> Any:
        return getattr(self._port, name)

    def write(self, data: bytes, /) -> int | None:
        """Write all bytes; waits at most the spacing, if the last write was less than it ago."""
        if data and self._written is not None:
            left = self._spacing - (self._clock() - self._written)
            if left > 0:
                threading.Event().wait(min(left, self._spacing))
        written = self._port.write(data)
        if data:
            self._written = self._clock()
        return written


def spaced(open_port: Opener, spacing: float, clock: Clock) -> Opener:
    """Return an opener of the same port with at least `spacing` [s] between its writes."""
    return lambda: cast(Port, SpacedPort(open_port(), spacing, clock))
