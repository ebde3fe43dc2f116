"""Conformance tests of robots against PROTOCOL.md: `cubeling robot conform PORT`, as a library."""

from cubeling.robot.conformance.channel import Channel, PortChannel, SimulatedChannel
from cubeling.robot.conformance.check import Check
from cubeling.robot.conformance.suite import (
    CheckResult,
    ConformanceReport,
    all_checks,
    run_checks,
    select_checks,
)

__all__ = [
    "Channel",
    "Check",
    "CheckResult",
    "ConformanceReport",
    "PortChannel",
    "SimulatedChannel",
    "all_checks",
    "run_checks",
    "select_checks",
]
