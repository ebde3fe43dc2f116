"""Plant the faults of robot makers in a robot, and test that `cubeling robot conform` finds them.

`python -m tests.campaigns.mutants` prints a table; the exit code is 1 if it finds less than 95 % of
them in a version of the protocol, or if a robot without a fault does not conform.

The robot is the firmware (`tests/robot/conformance/planted`), in virtual time. A fault counts as
found if the robot does not conform, or does not even answer; one that only makes a robot worse, if
the check that should notice it fails. A run ends with the check that finds the fault.
"""

import argparse
import os
import sys
from collections.abc import Iterable
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass

from rich.console import Console
from rich.table import Table

from cubeling.robot.conformance import CheckResult, SimulatedChannel, all_checks, run_checks
from cubeling.robot.errors import RobotError
from tests.robot.conformance.planted import FAULTS
from tests.robot.conformance.planted.robot import VERSIONS, PlantedFault, planted_robot

MIN_SHARE = 0.95
"""Smallest share of the faults that is found."""

NO_ANSWER = "no answer"
"""What finds a robot that never says WELCOME."""

HOST = 77
"""Number of the host."""


@dataclass(frozen=True)
class Finding:
    """What the suite says of a robot with a fault."""

    fault: PlantedFault
    version: int
    """Version of the protocol that the robot speaks."""

    found_by: str
    """Name of the first check that finds the fault; empty if none does."""


class _FoundError(Exception):
    """Ends a run."""


def find_fault(fault: PlantedFault, version: int) -> Finding:
    """Run the suite against a robot with a fault, until a check finds it."""

    def end_if_found(result: CheckResult) -> None:
        if result.verdict == "failed" and result.check.level in ("must", fault.level):
            raise _FoundError(result.check.name)

    with planted_robot(version, fault.edits) as robot:
        try:
            report = run_checks(SimulatedChannel(robot), all_checks(), HOST, end_if_found)
        except RobotError:
            return Finding(fault, version, NO_ANSWER)
        except _FoundError as found:
            return Finding(fault, version, str(found))
    return Finding(fault, version, report.cut_short)


def honest_failures() -> list[str]:
    """Return the checks that robots without a fault fail."""
    failures = []
    for version in VERSIONS:
        with planted_robot(version) as robot:
            report = run_checks(SimulatedChannel(robot), all_checks(), HOST)
        failures += [one.check.name for one in report.results if one.verdict == "failed"]
    return failures


def table_of(findings: Iterable[Finding]) -> Table:
    """Return the findings, a row for each fault and a column for each version."""
    table = Table("fault", *(f"version {version}" for version in VERSIONS), title="planted faults")
    rows: dict[str, dict[int, str]] = {}
    for one in findings:
        rows.setdefault(one.fault.name, {})[one.version] = one.found_by
    for name, found_by in rows.items():
        cells = [found_by.get(version, "–") or "[red]missed" for version in VERSIONS]
        table.add_row(name, *cells)
    return table


def main() -> int:
    """Run the campaign; return 1 if too few faults are found."""
    parser = argparse.ArgumentParser(description="Test the conformance suite by planted faults.")
    parser.add_argument("--every", type=int, default=1, help="only every so many-th run")
    parser.add_argument("--only", default="", help="only faults with these words in their names")
    parser.add_argument("--jobs", type=int, default=os.cpu_count(), help="processes")
    wanted = parser.parse_args()
    runs = [(one, version) for one in FAULTS if wanted.only in one.name for version in one.versions]
    runs = runs[:: wanted.every]
    with ProcessPoolExecutor(wanted.jobs) as pool:
        findings = list(pool.map(find_fault, *zip(*runs, strict=True), chunksize=4))
    console = Console(width=150)
    console.print(table_of(findings))
    wrong = honest_failures()
    if wrong:
        console.print(f"a robot without a fault fails: {', '.join(wrong)}", style="red")
    for version in VERSIONS:
        here = [one for one in findings if one.version == version]
        found = sum(bool(one.found_by) for one in here)
        share = found / len(here) if here else 1.0
        if share < MIN_SHARE:
            wrong.append(f"version {version}")
        console.print(f"version {version}: {found} of {len(here)} found, {100 * share:.1f} %")
    found = sum(bool(one.found_by) for one in findings)
    console.print(
        f"{len({one.fault.name for one in findings})} faults in {len(findings)} robots: "
        f"{found} found, {100 * found / len(findings):.1f} %",
        style="red" if wrong else "green",
    )
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
