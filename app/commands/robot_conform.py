"""`cubeling robot conform`."""

import json
import secrets
import textwrap
import time
from itertools import zip_longest
from pathlib import Path
from typing import Annotated, Any

import typer
from rich.console import Console
from rich.table import Table
from rich.text import Text

from app.errors import AppError
from robot.conformance import Check, PortLine, Report, Result, all_checks, chosen, examine
from robot.errors import RobotError
from robot.link.transport import opener

MARKS = {"ok": ("ok", "green"), "failed": ("FAILED", "bold red"), "skipped": ("skipped", "dim")}
POOR = ("poor", "yellow")
"""The mark of a failed check that is only about being better."""

NAME_WIDTH = 38
"""Columns for the name of a check."""

MARGIN = 18
"""Columns before what was expected and what came."""

PICTURE_WIDTH = 100
"""Columns of a picture of the output."""

SVG = """\
<svg class="rich-terminal" viewBox="0 0 {width} {height}" xmlns="http://www.w3.org/2000/svg">
<style>
.{unique_id}-matrix {{
  font: {char_height}px ui-monospace, Menlo, Consolas, "DejaVu Sans Mono", monospace;
}}
.{unique_id}-title {{ font: bold 16px sans-serif; }}
{styles}
</style>
<defs>
<clipPath id="{unique_id}-clip-terminal">
<rect x="0" y="0" width="{terminal_width}" height="{terminal_height}"/>
</clipPath>
{lines}
</defs>
{chrome}
<g transform="translate({terminal_x}, {terminal_y})" clip-path="url(#{unique_id}-clip-terminal)">
{backgrounds}
<g class="{unique_id}-matrix">
{matrix}
</g>
</g>
</svg>
"""
"""How the output becomes a picture: like Rich's own, but with no font from the network."""


def conform(
    port: Annotated[
        str,
        typer.Argument(
            metavar="PORT", help="/dev/ttyACM0, COM3, socket://HOST:PORT, sim:cubeling …"
        ),
    ] = "",
    only: Annotated[
        list[str] | None,
        typer.Option(help="Only checks with this in their names; may be given again."),
    ] = None,
    output: Annotated[
        Path | None, typer.Option("--json", help="Write what was found to this file too.")
    ] = None,
    picture: Annotated[
        Path | None, typer.Option("--svg", help="Draw the output into this file too.")
    ] = None,
    list_: Annotated[bool, typer.Option("--list", help="Say what is checked, and end.")] = False,
) -> None:
    """Check whether a robot keeps to robot/PROTOCOL.md, and say where it does not.

    Works with any robot: ours, your own firmware, a stranger's. It takes a minute, and more
    with a slow robot. The robot shows its moods and motions meanwhile, and is neutral at the end.
    Use a good cable: every frame counts.

    Ends with exit code 0 if the robot does all that it must, 1 if not, 2 if nobody answers.

    Example: [cyan]cubeling robot conform /dev/ttyACM0[/]
    """
    checks = chosen(only) if only else all_checks()
    if list_:
        Console().print(listing(checks))
        return
    for path in (output, picture):
        if path is not None:  # what cannot be written is better known before than after
            _writable(path)
    console = Console(highlight=False, record=picture is not None)
    if picture is not None:
        console.width = PICTURE_WIDTH
    report = _examined(port, checks, console)
    console.print()
    console.print(verdict(report), soft_wrap=picture is None)
    if output is not None:
        try:
            output.write_text(json.dumps(as_json(report, port), indent=1) + "\n", "utf-8")
        except OSError as error:
            raise AppError(f"cannot write '{output}': {error.strerror}") from error
    if picture is not None:
        console.save_svg(str(picture), title="cubeling robot conform", code_format=SVG)
    if not report.conforms:
        raise typer.Exit(1)


def _writable(path: Path) -> None:
    """Refuse what cannot be written, or would be waited for."""
    if path.is_fifo():
        raise AppError(f"cannot write '{path}': it is a pipe, no file")
    path.open("a").close()


def _examined(port: str, checks: list[Check], console: Console) -> Report:
    """Try what is behind a port, and print what each check finds."""
    line = opener(port)()
    try:
        return examine(
            PortLine(line, time.monotonic),
            checks,
            secrets.randbits(32),
            lambda result: show(result, console),
        )
    except RobotError as error:
        raise RobotError(f"{port}: {error}") from error
    finally:
        line.close()


def show(result: Result, console: Console) -> None:
    """Print what one check found."""
    mark, style = MARKS[result.verdict]
    if result.verdict == "failed" and result.check.level == "should":
        mark, style = POOR
    console.print(
        Text.assemble(
            (f"{mark:8}", style),
            f"{result.check.name:{NAME_WIDTH}}",
            (f"§{result.check.section}  {result.remark}".rstrip(), "dim"),
        ),
        soft_wrap=True,
    )
    if result.verdict != "failed":
        return
    for word, told in (
        ("required", result.check.requires),
        ("expected", result.expected),
        ("came", result.came),
    ):
        lines = textwrap.wrap(told, console.width - MARGIN, break_on_hyphens=False) or [""]
        for head, line in zip_longest([word], lines, fillvalue=""):
            # The margins have no style, so that a picture does not take them for text.
            parts = ("        ", (f"{head:{MARGIN - 8}}", "dim" if head else ""), (line, "not dim"))
            console.print(Text.assemble(*parts), soft_wrap=True)


def verdict(report: Report) -> Text:
    """Return the last line: whether the robot conforms."""
    welcome = report.welcome
    counts = {
        mark: sum(result.verdict == mark for result in report.results)
        for mark in ("ok", "failed", "skipped")
    }
    numbers = ", ".join(f"{count} {mark}" for mark, count in counts.items() if count)
    good, bad = ("It conforms.", "bold green"), ("It does not conform.", "bold red")
    cut = f" The rest was left out: {report.cut_short}." if report.cut_short else ""
    return Text.assemble(
        f"{welcome.name} ({welcome.firmware}), version {welcome.version}: ",
        f"{numbers} in {report.seconds:.0f} s. ",
        good if report.conforms else bad,
        cut,
    )


def listing(checks: list[Check]) -> Table:
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
