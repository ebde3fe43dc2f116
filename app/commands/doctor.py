"""`cubeling doctor`."""

from typing import Annotated

import typer
from rich.console import Console
from rich.table import Table

from app.commands.doctor_checks import Finding, examine

MARKS = {"good": "[green]✓[/]", "missing": "[yellow]–[/]", "bad": "[red]✗[/]"}


def doctor(
    cameras: Annotated[bool, typer.Option(help="Look for a camera too (takes about 5 s).")] = True,
) -> None:
    """Say what this computer has, what is missing, and the command that puts it right.

    Ends with exit code 2 if something is missing without which Cubeling cannot draw or track.

    Example: [cyan]cubeling doctor[/]
    """
    findings = examine(cameras=cameras)
    table = Table.grid(padding=(0, 2))
    for finding in findings:
        table.add_row(MARKS[finding.verdict], f"[bold]{finding.what}[/]", _told(finding))
    console = Console()
    console.print(table)
    if any(finding.verdict == "bad" for finding in findings):
        raise typer.Exit(2)
    console.print("\nReady. [cyan]cubeling demo[/] shows it.")


def _told(finding: Finding) -> str:
    return f"{finding.found}\n[cyan]{finding.remedy}[/]" if finding.remedy else finding.found
