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
from robot.conformance import (
    Check,
    CheckResult,
    ConformanceReport,
    PortChannel,
    all_checks,
    run_checks,
    select_checks,
)
from robot.errors import RobotError
from robot.link.transport import opener

VERDICT_LABELS = {
    "ok": ("ok", "green"),
    "failed": ("FAILED", "bold red"),
    "skipped": ("skipped", "dim"),
}
FAILED_SHOULD_LABEL = ("poor", "yellow")
"""The label of a failed check of level "should"."""

NAME_COLUMNS = 38
"""Width of the name of a check."""

DETAIL_INDENT = 18
"""Columns before the texts that explain a failure."""

PICTURE_COLUMNS = 100
"""Width of a picture of the output."""

SVG_TEMPLATE = """\
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
"""The picture of the output: like Rich's own template, but without a font from the network."""


def conform(
    port: Annotated[
        str,
        typer.Argument(metavar="PORT", help="/dev/ttyACM0, COM3, socket://HOST:PORT, sim:cubeling"),
    ] = "",
    only: Annotated[
        list[str] | None,
        typer.Option(help="Only checks with this word in their names; repeatable."),
    ] = None,
    output: Annotated[Path | None, typer.Option("--json", help="Write the results here.")] = None,
    picture: Annotated[
        Path | None, typer.Option("--svg", help="Write the output to this file as a picture too.")
    ] = None,
    list_: Annotated[bool, typer.Option("--list", help="List the checks, and exit.")] = False,
) -> None:
    """Test whether a robot conforms to robot/PROTOCOL.md, and report where it does not.

    Works with any robot: ours, or one with your own firmware. It takes a minute, or more with a
    slow robot. The robot shows its moods and motions during the test, and is neutral at the end.
    Use a good cable: every frame counts.

    The exit code is 0 if the robot conforms, 1 if not, 2 if no robot answers.

    Example: [cyan]cubeling robot conform /dev/ttyACM0[/]
    """
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
        try:
            output.write_text(json.dumps(as_json(report, port), indent=1) + "\n", "utf-8")
        except OSError as error:
            raise AppError(f"cannot write '{output}': {error.strerror}") from error
    if picture is not None:
        console.save_svg(str(picture), title="cubeling robot conform", code_format=SVG_TEMPLATE)
    if not report.conforms:
        raise typer.Exit(1)


def _check_writable(path: Path) -> None:
    """Refuse a file that cannot be written, and a pipe, on which writing would block."""
    if path.is_fifo():
        raise AppError(f"cannot write '{path}': it is a pipe, not a file")
    path.open("a").close()


def _run_checks(port: str, checks: list[Check], console: Console) -> ConformanceReport:
    """Test the robot at a port, and print each result."""
    opened = opener(port)()
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


def show(result: CheckResult, console: Console) -> None:
    """Print the result of a check."""
    label, style = VERDICT_LABELS[result.verdict]
    if result.verdict == "failed" and result.check.level == "should":
        label, style = FAILED_SHOULD_LABEL
    console.print(
        Text.assemble(
            (f"{label:8}", style),
            f"{result.check.name:{NAME_COLUMNS}}",
            (f"§{result.check.section}  {result.remark}".rstrip(), "dim"),
        ),
        soft_wrap=True,
    )
    if result.verdict != "failed":
        return
    for word, text in (
        ("required", result.check.requires),
        ("expected", result.expected),
        ("received", result.received),
    ):
        lines = textwrap.wrap(text, console.width - DETAIL_INDENT, break_on_hyphens=False) or [""]
        for head, line in zip_longest([word], lines, fillvalue=""):
            # The indent has no style, so a picture does not draw it as text.
            title = (f"{head:{DETAIL_INDENT - 8}}", "dim" if head else "")
            console.print(Text.assemble("        ", title, (line, "not dim")), soft_wrap=True)


def verdict(report: ConformanceReport) -> Text:
    """Return the last line: whether the robot conforms."""
    welcome = report.welcome
    counts = {
        verdict: sum(result.verdict == verdict for result in report.results)
        for verdict in ("ok", "failed", "skipped")
    }
    numbers = ", ".join(f"{count} {verdict}" for verdict, count in counts.items() if count)
    good, bad = ("It conforms.", "bold green"), ("It does not conform.", "bold red")
    cut = f" The other checks were skipped: {report.cut_short}." if report.cut_short else ""
    return Text.assemble(
        f"{welcome.name} ({welcome.firmware}), version {welcome.version}: ",
        f"{numbers} in {report.seconds:.0f} s. ",
        good if report.conforms else bad,
        cut,
    )


def listing(checks: list[Check]) -> Table:
    """Return a table of the checks."""
    table = Table("§", "check", "level", "requirement", box=None, pad_edge=False)
    for check in checks:
        table.add_row(str(check.section), check.name, check.level, check.requires)
    return table


def as_json(report: ConformanceReport, port: str) -> dict[str, Any]:
    """Return a report for JSON."""
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
                "came": result.received,
                "remark": result.remark,
                "seconds": round(result.seconds, 3),
            }
            for result in report.results
        ],
    }
