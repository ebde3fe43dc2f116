"""`cubeling robot conform`."""

import json
import secrets
import time
from pathlib import Path
from typing import Annotated, Any

import typer
from rich.console import Console
from rich.padding import Padding
from rich.table import Table
from rich.text import Text

from robot.conformance import PortLine, Report, Result, all_checks, chosen, examine
from robot.errors import RobotError
from robot.transport import opener

MARKS = {"ok": ("ok", "green"), "failed": ("FAILED", "bold red"), "skipped": ("skipped", "dim")}
POOR = ("poor", "yellow")

NAME_WIDTH = 38
"""Columns for the name of a check."""


def conform(
    port: Annotated[
        str,
        typer.Argument(help="/dev/ttyACM0, COM3, socket://HOST:PORT, sim:cubeling", metavar="PORT"),
    ] = "",
    only: Annotated[
        list[str] | None,
        typer.Option(help="Only checks with this in their names; may be given again."),
    ] = None,
    output: Annotated[
        Path | None, typer.Option("--json", help="Write what was found to this file too.")
    ] = None,
    list_: Annotated[bool, typer.Option("--list", help="Say what is checked, and end.")] = False,
) -> None:
    """Check whether a robot keeps to robot/PROTOCOL.md, and say where it does not.

    Works with any robot: ours, your own firmware, a stranger's. It is spoken to for at most a
    minute, shows all its moods and motions, and is neutral at the end. Use a good cable: a check
    tries everything once.

    Ends with exit code 0 if the robot does all that it must, 1 if not, 2 if nobody answers.

    Example: [cyan]cubeling robot conform /dev/ttyACM0[/]
    """
    console = Console(highlight=False)
    checks = chosen(only) if only else all_checks()
    if list_:
        console.print(listing(checks))
        return
    if output is not None:
        output.write_text("")  # a file that cannot be written is better known before than after
    line_port = opener(port)()
    try:
        report = examine(
            PortLine(line_port, time.monotonic),
            checks,
            secrets.randbits(32),
            lambda result: show(result, console),
        )
    except RobotError as error:
        raise RobotError(f"{port}: {error}") from error
    finally:
        line_port.close()
    console.print(verdict(report), soft_wrap=True)
    if output is not None:
        output.write_text(json.dumps(as_json(report, port), indent=1) + "\n", "utf-8")
    if not report.conforms:
        raise typer.Exit(1)


def show(result: Result, console: Console) -> None:
    """Print what one check found."""
    mark, style = MARKS[result.verdict]
    if result.verdict == "failed" and result.check.level == "should":
        mark, style = POOR
    line = Text.assemble(
        (f"{mark:8}", style),
        f"{result.check.name:{NAME_WIDTH}}",
        (f"§{result.check.section}  {result.remark}".rstrip(), "dim"),
    )
    console.print(line, soft_wrap=True)
    if result.verdict == "failed":
        told = (
            ("required", result.check.requires),
            ("expected", result.expected),
            ("came", result.came),
        )
        grid = Table.grid(padding=(0, 2))
        for word, text in told:
            grid.add_row(Text(word, "dim"), Text(text))
        console.print(Padding(grid, (0, 0, 0, 8)))


def verdict(report: Report) -> Text:
    """Return the last line: whether the robot conforms."""
    welcome = report.welcome
    counts = {
        mark: sum(result.verdict == mark for result in report.results)
        for mark in ("ok", "failed", "skipped")
    }
    numbers = ", ".join(f"{count} {mark}" for mark, count in counts.items() if count)
    ending = (
        ("It conforms.", "bold green") if report.conforms else ("It does not conform.", "bold red")
    )
    cut = f" The rest was left out: {report.cut_short}." if report.cut_short else ""
    return Text.assemble(
        f"\n{welcome.name} ({welcome.firmware}), version {welcome.version}: ",
        f"{numbers} in {report.seconds:.0f} s. ",
        ending,
        cut,
    )


def listing(checks: list[Any]) -> Table:
    """Return a table of what is checked."""
    table = Table("§", "check", "level", "what is required", box=None, pad_edge=False)
    for check in checks:
        table.add_row(str(check.section), check.name, check.level, check.requires)
    return table


def as_json(report: Report, port: str) -> dict[str, Any]:
    """Return a report as JSON has it."""
    return {
        "port": port,
        "robot": report.welcome.name,
        "firmware": report.welcome.firmware,
        "version": report.welcome.version,
        "conforms": report.conforms,
        "cut_short": report.cut_short,
        "seconds": round(report.seconds, 3),
        "checks": [
            {
                "name": result.check.name,
                "section": result.check.section,
                "level": result.check.level,
                "verdict": result.verdict,
                "required": result.check.requires,
                "expected": result.expected,
                "came": result.came,
                "remark": result.remark,
                "seconds": round(result.seconds, 3),
            }
            for result in report.results
        ],
    }
