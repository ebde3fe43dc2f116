"""The protocols: one package for each, registered here so that `connect` finds them."""

from pathlib import Path

from robot.contract.driver import DRIVERS, Driver, DriverKind
from robot.drivers.cubeling.host import HostLink
from robot.drivers.opencat.host import OpenCatHost
from robot.drivers.opencat.settings import load_settings as opencat_settings
from robot.drivers.pleo import timing as pleo
from robot.drivers.pleo.driver import PleoDriver
from robot.drivers.pleo.settings import load_settings as pleo_settings
from robot.drivers.reachy.driver import ReachyDriver
from robot.drivers.reachy.port import open_reachy
from robot.errors import RobotError
from robot.protocol import timing


def _cubeling(host: int, settings: Path | None) -> Driver:
    if settings is not None:
        raise RobotError(f"{settings}: the protocol 'cubeling' has no settings; leave them out")
    # Not from session 1: an answer to the program before may still be on the line, and a robot that
    # missed our greeting is in its session.
    return HostLink(host, session=host % 0xFFFF + 1)


def _opencat(host: int, settings: Path | None) -> Driver:
    return OpenCatHost(opencat_settings(settings))


def _pleo(host: int, settings: Path | None) -> Driver:
    return PleoDriver(pleo_settings(settings))


def _reachy(host: int, settings: Path | None) -> Driver:
    if settings is not None:
        raise RobotError(f"{settings}: Reachy Mini's driver has no settings; leave them out")
    return ReachyDriver()


_OPENCAT = DriverKind(
    _opencat,
    115200,
    25.0,  # a board takes seconds to start when its port is opened, and a new one asks its owner
    spacing=0.1,  # what is written within a few milliseconds is read as one line
)

__all__ = ["DRIVERS"]

DRIVERS |= {
    "cubeling": DriverKind(_cubeling, timing.BAUD, timing.ANSWER_WITHIN),
    "opencat": _OPENCAT,
    "nybble": _OPENCAT,  # so that "sim:nybble" needs no protocol named
    "pleo": DriverKind(_pleo, pleo.BAUD, pleo.ANSWER_TIMEOUT_S),
    # It has no serial port of its own; its daemon is reached over the network, and it gets up.
    "reachy": DriverKind(_reachy, 0, 10.0, open_reachy),
}
