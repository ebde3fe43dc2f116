"""The protocols: one package for each, and the table by which `connect` finds them."""

from pathlib import Path

from robot.driver import Driver, DriverKind
from robot.drivers.cubeling.host import HostLink
from robot.errors import RobotError
from robot.protocol import timing


def _cubeling(host: int, settings: Path | None) -> Driver:
    if settings is not None:
        raise RobotError(f"{settings}: the protocol 'cubeling' has no settings; leave them out")
    return HostLink(host)


DRIVERS: dict[str, DriverKind] = {
    "cubeling": DriverKind(_cubeling, timing.BAUD, timing.ANSWER_WITHIN),
}
"""The protocols by name."""
