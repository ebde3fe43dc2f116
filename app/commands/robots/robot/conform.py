"""The command `cubeling robot conform`."""

from __future__ import annotations

import json
import os
import secrets
import time
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer
from rich.console import Console

from cubeling.app.errors import AppError
from cubeling.files import write_whole

if TYPE_CHECKING:
    from cubeling.robot.conformance import Check, ConformanceReport

PICTURE_COLUMNS = 100
"""Width of a picture of the output."""


def conform(
    port: Annotated[
        str,
        typer.Argument(metavar="PORT", help="/dev/ttyACM0, COM3, socket://HOST:PORT or sim."),
    ] = "",
    only: Annotated[
        list[str] | None,
        typer.Option(help="Run only checks with this word in their names. Repeatable."),
    ] = None,
    output: Annotated[Path | None, typer.Option("--json", help="Write the results to it.")] = None,
    picture: Annotated[
        Path | None, typer.Option("--svg", help="Write the output to this .svg file as well.")
    ] = None,
    list_: Annotated[bool, typer.Option("--list", help="List the checks and exit.")] = False,
) -> None:
    """Test whether a robot conforms to robot/PROTOCOL.md, and report where it does not.

    Works with any robot: ours, or one with your own firmware. It takes a minute, or more with a
    slow robot. The robot shows its moods and motions during the test, and is neutral at the end.
    Use a good cable: every frame counts.

    The exit code is 0 if the robot passes all checks that were run, 1 if not, 2 if no robot
    answers.

    Example: cubeling robot conform sim
    """
    from cubeling.app.commands.robots.robot.conformance_report import (
        SVG_TEMPLATE,
        as_json,
        listing,
        verdict,
    )
    from cubeling.robot.conformance import all_checks, select_checks

    checks = select_checks(only) if only else all_checks()
    if list_:
        Console().print(listing(checks))
        return
    for path in (output, picture):
        if path is not None:  # fail before the checks, not after them
            _check_writable(path)
    console = Console(highlight=False, record=picture is not None)
    if picture is not None:
        console.width = PICTURE_COLUMNS
    report = _run_checks(port, checks, console)
    console.print()
    console.print(verdict(report), soft_wrap=picture is None)
    if output is not None:
        text = json.dumps(as_json(report, port), indent=1) + "\n"
        write_whole(output, text, AppError)
    if picture is not None:
        drawn = console.export_svg(title="cubeling robot conform", code_format=SVG_TEMPLATE)
        write_whole(picture, drawn, AppError)
    if not report.conforms:
        raise typer.Exit(1)


def _check_writable(path: Path) -> None:
    """Refuse a file that cannot be written, without touching it."""
    folder = path.parent
    reason = ""
    if not folder.is_dir():
        reason = f"there is no folder '{folder}'"
    elif path.exists() and not path.is_file():  # on a pipe, writing would block
        reason = "it is not a file"
    elif not os.access(path if path.exists() else folder, os.W_OK):
        reason = "no permission"
    if reason:
        raise AppError(f"cannot write '{path}': {reason}")


def _run_checks(port: str, checks: list[Check], console: Console) -> ConformanceReport:
    """Test the robot at a port, and print each result."""
    from cubeling.app.commands.robots.robot.conformance_report import show
    from cubeling.robot import RobotError, opener, protocol_of
    from cubeling.robot.conformance import PortChannel, run_checks

    opened = opener(protocol_of(port, "cubeling")[0])()
    try:
        return run_checks(
            PortChannel(opened, time.monotonic),
            checks,
            secrets.randbits(32),
            lambda result: show(result, console),
        )
    except RobotError as error:
        raise RobotError(f"{port}: {error}") from error
    finally:
        opened.close()
