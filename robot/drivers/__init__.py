"""The protocols by name: one package each, registered here for `connect`."""

from robot.contract.driver import DRIVERS
from robot.drivers.cubeling.host import CUBELING
from robot.drivers.opencat.host import OPENCAT
from robot.drivers.pleo.driver import PLEO
from robot.drivers.reachy.driver import REACHY

__all__ = ["DRIVERS"]

DRIVERS |= {
    "cubeling": CUBELING,
    "opencat": OPENCAT,
    "nybble": OPENCAT,  # so that "sim:nybble" needs no protocol
    "pleo": PLEO,
    "reachy": REACHY,
}
