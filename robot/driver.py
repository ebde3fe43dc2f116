"""What every protocol's host end can do, and which protocols there are."""

from collections.abc import Callable
from typing import Protocol

from robot.catalogue import Catalogue
from robot.emotion import Emotion
from robot.host import HostLink
from robot.telemetry import LinkState, Telemetry


class Driver(Protocol):
    """A protocol's host end, without clock, thread or port; `HostLink` is one."""

    catalogue: Catalogue | None
    """What the robot has; None until it is known."""

    def express(self, emotion: Emotion) -> None:
        """Ask for an emotion; only the latest counts."""

    def play(self, item: int, index: int) -> bool:
        """Ask for a motion or a sound once; False if too many wait."""

    def stop(self) -> None:
        """Ask for the neutral pose."""

    def port_opened(self, now: float) -> None:
        """Begin, or begin again."""

    def port_lost(self) -> None:
        """Send nothing until the port is back."""

    def close(self) -> None:
        """Say goodbye."""

    def receive(self, data: bytes, now: float) -> None:
        """Take bytes from the line."""

    def tick(self, now: float) -> None:
        """Do what is due."""

    def bytes_to_send(self) -> bytes:
        """Return what is to be written, once."""

    def state(self, now: float) -> LinkState:
        """Return the state of the link."""

    def telemetry(self, now: float) -> Telemetry:
        """Return all that is known."""


DRIVERS: dict[str, Callable[[int], Driver]] = {"cubeling": HostLink}
"""The protocols by name; a driver is made from a number that tells this program from others."""
