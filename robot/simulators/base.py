"""What every simulated robot is: the far end of a line, without clock, thread or port."""

from typing import Protocol


class Simulated(Protocol):
    """A simulated robot. It has no clock: it lives until the time that it is told."""

    edge: bytes
    """The byte at which its protocol's frames or lines end; faults strike whole frames."""

    def receive(self, data: bytes, now: float) -> None:
        """Take bytes from the line at time `now` [s]."""

    def advance(self, now: float) -> None:
        """Live until time `now` [s]."""

    def bytes_to_send(self) -> bytes:
        """Return what is to be written to the line, once."""

    def reboot(self) -> None:
        """Lose power and come back."""

    def portrait(self) -> tuple[float, str]:
        """Return what it shows now: the mood from angry, −1, to happy, 1, and the word for it."""
