"""The log: lines for the robot's owner that wait to be sent."""

from .messages import LOG_BYTES

MAX_WAITING = 8
"""Lines that wait; when there are more, the new ones are dropped and counted."""


class LogQueue:
    """The first lines that were written and not yet sent; they survive an error."""

    def __init__(self) -> None:
        self._waiting: list[tuple[int, int, int, bytes]] = []
        self._count = 0

    def write(self, severity: int, text: str, now: int) -> None:
        """Write a line at `now` [ms]; a long one is shortened between two characters."""
        self._count = (self._count + 1) & 0xFFFF
        if len(self._waiting) >= MAX_WAITING:
            return
        data = text.encode()
        end = min(len(data), LOG_BYTES)
        while end < len(data) and data[end] & 0xC0 == 0x80:
            end -= 1  # inside a character
        self._waiting.append((self._count, now & 0xFFFFFFFF, severity, data[:end]))

    def pop(self) -> tuple[int, int, int, bytes] | None:
        """Return the fields of the next LOG, once; None if no line waits."""
        return self._waiting.pop(0) if self._waiting else None
