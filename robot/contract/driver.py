"""What every protocol's host end can do."""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Protocol

from affect.emotion import Emotion
from robot.contract.catalogue import Catalogue
from robot.contract.port import Clock, Opener
from robot.contract.telemetry import LinkState, Telemetry

ACTIONS_MAX = 4
"""Motions and sounds that may wait for a robot that plays one after the other; more are refused.
Our own protocol's robots are quicker, and more may wait (`robot.protocol.timing`)."""


class Driver(Protocol):
    """A protocol's host end, without clock, thread or port.

    Whoever owns those calls `receive` and `tick` with the time, and writes `bytes_to_send`. No
    method waits, and none raises because of what the robot says.
    """

    catalogue: Catalogue | None
    """What the robot has; None until it is known."""

    def express(self, emotion: Emotion, label: str | None = None) -> None:
        """Ask for an emotion; only the latest counts. `label` is the mood's word, if it has one."""

    def play(self, item: int, index: int) -> bool:
        """Ask for a motion or a sound of the catalogue once; False if too many wait."""

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


@dataclass(frozen=True)
class DriverKind:
    """A protocol, as `connect` needs to know it."""

    make: Callable[[int, Path | None], Driver]
    """Makes a driver from a number that tells this program from others, and a settings file or
    None; raises RobotError, in one line, for settings that are wrong."""

    baud: int
    """Bits a second on a real serial line; a driver's own attribute `baud`, where its settings have
    made one, goes before it."""

    answer_within: float
    """How long `connect` waits for the robot where its caller does not say [s]."""

    opener: Callable[[str, Clock], Opener] | None = None
    """Returns what opens the URL, for a robot that is on no serial port; None for one that is."""

    spacing: float = 0.0
    """Least time between two writes [s], for a robot that takes all that has come for one line."""


DRIVERS: dict[str, DriverKind] = {}
"""The protocols by name; `robot.drivers` registers those that come with the program."""
