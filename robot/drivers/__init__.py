"""The protocols by name: one package each, registered here for `connect`."""

from cubeling.robot.contract.driver import DRIVERS
from cubeling.robot.drivers.cubeling.host import CUBELING
from cubeling.robot.drivers.opencat.host import OPENCAT
from cubeling.robot.drivers.pleo.driver import PLEO
from cubeling.robot.drivers.reachy.driver import REACHY

__all__ = ["DRIVERS"]

DRIVERS |= {
    "cubeling": CUBELING,
    "opencat": OPENCAT,
    "nybble": OPENCAT,  # so that "sim:nybble" needs no protocol
    "pleo": PLEO,
    "reachy": REACHY,
}
