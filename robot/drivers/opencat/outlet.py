"""The one way on which lines go to a board: admitted ones alone, no faster than it takes them."""

import math

from robot.drivers.opencat import tokens


class Outlet:
    """Where lines for a board wait to be written.

    Parameters
    ----------
    per_second
        Most lines in a second.
    """

    def __init__(self, per_second: float) -> None:
        self.sent = 0
        """Lines sent."""
        self._apart = 1.0 / per_second
        self._last = -math.inf
        self._out = bytearray()

    def is_free(self, now: float) -> bool:
        """Whether a line may be sent at time `now` [s]."""
        return now - self._last >= self._apart

    def send(self, line: bytes, now: float) -> None:
        """Let a line go out at time `now` [s]; raises RobotError for one that may not be sent."""
        self._out += tokens.admitted(line)
        self._last = now
        self.sent += 1

    def bytes_to_send(self) -> bytes:
        """Return what is to be written to the line, once."""
        data = bytes(self._out)
        self._out.clear()
        return data

    def clear(self) -> None:
        """Forget what was not written."""
        self._out.clear()
