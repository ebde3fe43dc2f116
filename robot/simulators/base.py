"""The interface of a simulated robot, without clock, thread or port."""

from typing import Protocol


class Simulated(Protocol):
    """A simulated robot. It has no clock: the caller advances it to a time."""

    edge: bytes
    """The byte that ends a frame or a line of its protocol; faults affect whole frames."""

    def receive(self, data: bytes, now: float) -> None:
        """Process received bytes at time `now` [s]."""

    def advance(self, now: float) -> None:
        """Advance to time `now` [s]."""

    def bytes_to_send(self) -> bytes:
        """Return the bytes to write, once."""

    def reboot(self) -> None:
        """Restart, as after a loss of power."""

    def portrait(self) -> tuple[float, str]:
        """Return the mood that it shows, from −1, angry, to 1, happy, and its word."""
