"""The report of `cubeling robot conform`, for a person and for a program."""

import textwrap
from itertools import zip_longest
from typing import Any

from rich.console import Console
from rich.table import Table
from rich.text import Text

from cubeling.app.ui.literal_text import literal_text
from cubeling.robot.conformance import Check, CheckResult, ConformanceReport, all_checks

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


def show(result: CheckResult, console: Console) -> None:
    """Print the result of a check."""
    label, style = VERDICT_LABELS[result.verdict]
    if result.verdict == "failed" and result.check.level == "should":
        label, style = FAILED_SHOULD_LABEL
    console.print(
        Text.assemble(
            (f"{label:8}", style),
            f"{result.check.name:{NAME_COLUMNS}}",
            (literal_text(f"§{result.check.section}  {result.remark}".rstrip()).plain, "dim"),
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
        shown = literal_text(text).plain
        lines = textwrap.wrap(shown, console.width - DETAIL_INDENT, break_on_hyphens=False) or [""]
        for head, line in zip_longest([word], lines, fillvalue=""):
            # The indent has no style, so a picture does not draw it as text.
            title = (f"{head:{DETAIL_INDENT - 8}}", "dim" if head else "")
            console.print(Text.assemble("        ", title, (line, "not dim")), soft_wrap=True)


def verdict(report: ConformanceReport) -> Text:
    """Return the last line: whether the robot conforms, as far as the checks that were run say."""
    welcome = report.welcome
    counts = {
        verdict: sum(result.verdict == verdict for result in report.results)
        for verdict in ("ok", "failed", "skipped")
    }
    numbers = ", ".join(f"{count} {verdict}" for verdict, count in counts.items() if count)
    run, total = len(report.results), len(all_checks())
    conclusion = ("It does not conform.", "bold red")
    if report.conforms:
        conclusion = ("It conforms.", "bold green")
        if run < total:
            conclusion = ("It passes these, which is not the whole verdict.", "bold yellow")
    were = "was" if run == 1 else "were"
    cut = f" The other checks were skipped: {report.cut_short}." if report.cut_short else ""
    return Text.assemble(
        literal_text(f"{welcome.name} ({welcome.firmware})"),
        f", version {welcome.version}: ",
        f"{numbers} in {report.seconds:.0f} s. ",
        f"Only {run} of {total} checks {were} run. " if run < total else "",
        conclusion,
        cut,
    )


def listing(checks: list[Check]) -> Table:
    """Return a table of the checks."""
    table = Table("§", "check", "level", "requirement", box=None, pad_edge=False)
    for check in checks:
        table.add_row(str(check.section), check.name, check.level, check.requires)
    return table


def as_json(report: ConformanceReport, port: str) -> dict[str, Any]:
    """Return a report for JSON; "conforms" is None if only some checks were run, and passed."""
    whole = len(report.results) == len(all_checks())
    conforms = None if report.conforms and not whole else report.conforms
    return {
        "port": port,
        "robot": report.welcome.name,
        "firmware": report.welcome.firmware,
        "version": report.welcome.version,
        "conforms": conforms,
        "checks_run": len(report.results),
        "checks_in_all": len(all_checks()),
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
