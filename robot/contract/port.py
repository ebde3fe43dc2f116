"""What a link asks of a port, real or simulated."""

from collections.abc import Callable
from typing import Protocol

Clock = Callable[[], float]
"""The time [s]."""

READ_TIMEOUT = 0.020
"""Longest wait in one read [s]: how late a beat or a repeat may be, and a close be noticed."""


class Port(Protocol):
    """The part of pySerial's interface that a link uses."""

    @property
    def in_waiting(self) -> int:
        """Bytes that can be read at once."""

    def read(self, size: int = 1, /) -> bytes:
        """Read up to `size` bytes, waiting a bounded time for them."""

    def write(self, data: bytes, /) -> int | None:
        """Write all of the bytes, or raise after a bounded time."""

    def close(self) -> None:
        """Give the port back."""


Opener = Callable[[], Port]
"""Opens a port, the first time and again; raises RobotError while it cannot."""
