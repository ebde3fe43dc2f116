"""What a link needs of a port, real or simulated."""

from collections.abc import Callable
from typing import Literal, Protocol

Clock = Callable[[], float]
"""Returns the time [s]."""

Direction = Literal["tx", "rx"]
"""From the host to the robot, or back."""

ByteHook = Callable[[Direction, bytes, float], None]
"""Called with a direction, the bytes and the time [s]."""

READ_TIMEOUT_S = 0.005
"""Longest wait in one read [s]: a beat, a retry or a close is late by this much at most, and a beat
is due every 50 ms."""


class Port(Protocol):
    """The part of pySerial's interface that a link uses."""

    @property
    def in_waiting(self) -> int:
        """Number of bytes that can be read at once."""

    def read(self, size: int = 1, /) -> bytes:
        """Read up to `size` bytes; waits at most `READ_TIMEOUT_S` for the first."""

    def write(self, data: bytes, /) -> int | None:
        """Write all bytes, or raise after a bounded time."""

    def close(self) -> None:
        """Release the port; a second call does nothing."""


Opener = Callable[[], Port]
"""Opens a port, the first time and again; raises RobotError while it cannot."""


class SendBuffer:
    """Base of objects that collect bytes for a port."""

    def __init__(self) -> None:
        self._out = bytearray()

    @property
    def unsent(self) -> int:
        """Number of bytes that wait for `bytes_to_send`."""
        return len(self._out)

    def bytes_to_send(self) -> bytes:
        """Return the bytes to write, once."""
        data = bytes(self._out)
        self._out.clear()
        return data
