"""The host side of a protocol, as the link sees it."""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Protocol

from cubeling.affect import Emotion
from cubeling.registry import Registry
from cubeling.robot.contract.catalogue import Catalogue
from cubeling.robot.contract.moves import JointMover
from cubeling.robot.contract.port import Clock, Opener
from cubeling.robot.contract.telemetry import LinkState, Telemetry

MAX_QUEUED_ACTIONS = 4
"""Motions and sounds that may wait for a robot that plays one after the other; more are refused.
The protocol "cubeling" allows more (`robot.protocol.timing.ACTIONS_MAX`): its robots are faster."""


class Driver(Protocol):
    """The host side of a protocol, without clock, thread or port.

    The owner calls `receive` and `tick` with the time and writes `bytes_to_send`. No method waits,
    and none raises because of what the robot sends.
    """

    catalogue: Catalogue | None
    """What the robot has; None until it is known."""

    @property
    def joint_mover(self) -> JointMover | None:
        """Turns single joints; None if this robot cannot do that, and while it is not known."""

    def express(self, emotion: Emotion) -> None:
        """Request an emotion; only the latest counts."""

    def play(self, item: int, index: int) -> bool:
        """Request a motion or a sound of the catalogue once; return False if too many wait.

        Without a session it is dropped at once, so that it is not played late.
        """

    def stop(self) -> None:
        """Request the neutral pose."""

    def port_opened(self, now: float) -> None:
        """Start a session; called at the first opening of the port and at every later one."""

    def port_lost(self) -> None:
        """Send nothing until `port_opened`."""

    def close(self) -> None:
        """End the session; `bytes_to_send` then returns the last bytes."""

    def receive(self, data: bytes, now: float) -> None:
        """Parse bytes from the robot, in pieces of any size."""

    def tick(self, now: float) -> None:
        """Do what is due."""

    def bytes_to_send(self) -> bytes:
        """Return the bytes to write, once."""

    def state(self, now: float) -> LinkState:
        """Return the state of the link."""

    def telemetry(self, now: float) -> Telemetry:
        """Return everything that is known of the robot."""


@dataclass(frozen=True)
class DriverKind:
    """What `connect` needs to know of a protocol."""

    make: Callable[[int, Path | None], Driver]
    """Makes a driver from a number that identifies this program and a settings file or None; raises
    RobotError for wrong settings."""

    baud: int
    """Bits per second on a real serial line; a driver's attribute `baud` overrides it."""

    answer_within: float
    """Default time that `connect` waits for the robot [s]."""

    opener: Callable[[str, Clock], Opener] | None = None
    """Makes the opener of a URL for a robot without a serial port; None for a serial port."""

    spacing: float = 0.0
    """Minimum time between two writes [s], for robots that take everything that has arrived as one
    line."""


DRIVERS = Registry[DriverKind](
    {
        "cubeling": "cubeling.robot.drivers.cubeling.host:CUBELING",
        "opencat": "cubeling.robot.drivers.opencat.host:OPENCAT",
        "nybble": "cubeling.robot.drivers.opencat.host:OPENCAT",  # "sim:nybble" needs no protocol
        "pleo": "cubeling.robot.drivers.pleo.driver:PLEO",
        "reachy": "cubeling.robot.drivers.reachy.driver:REACHY",
    }
)
"""The protocols by name; a new one is registered here."""
