"""Simulated robots: a package each, and the table in which "sim:NAME" finds them."""

from collections.abc import Callable

from robot.simulators.base import Simulated
from robot.simulators.cubeling.simulator import Simulator
from robot.simulators.opencat.simulator import OpenCatSimulator, nybble
from robot.simulators.pleo.simulator import PleoSimulator

SIMULATORS: dict[str, Callable[[int], Simulated]] = {
    "cubeling": Simulator,
    "opencat": OpenCatSimulator,
    "nybble": nybble,
    "pleo": PleoSimulator,
}
"""The simulated robots by name; each is made from a seed."""
