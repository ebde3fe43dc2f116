"""Simulated robots: a package each, and the table in which "sim:NAME" finds them."""

from collections.abc import Callable
from typing import Protocol

from cubeling.registry import Registry


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


SIMULATORS = Registry[Callable[[int], Simulated]](
    {
        "cubeling": "cubeling.robot.simulators.cubeling.simulator:Simulator",
        "opencat": "cubeling.robot.simulators.opencat.simulator:OpenCatSimulator",
        "nybble": "cubeling.robot.simulators.opencat.simulator:nybble",
        "pleo": "cubeling.robot.simulators.pleo.simulator:PleoSimulator",
    }
)
"""The simulated robots by name; each is made from a seed."""
