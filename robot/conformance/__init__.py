"""Does a robot keep to PROTOCOL.md? `cubeling robot conform PORT`, as a library."""

from robot.conformance.check import Check
from robot.conformance.line import Line, PortLine, SimulatedLine
from robot.conformance.suite import Report, Result, all_checks, chosen, examine

__all__ = [
    "Check",
    "Line",
    "PortLine",
    "Report",
    "Result",
    "SimulatedLine",
    "all_checks",
    "chosen",
    "examine",
]
