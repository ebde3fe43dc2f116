"""The command `cubeling diff`."""

from pathlib import Path
from typing import Annotated

import typer
from rich.box import SIMPLE_HEAD
from rich.console import Console
from rich.table import Table
from rich.text import Text

from cubeling.app.input_path import check_input


def diff(
    first: Annotated[Path, typer.Argument(help="A session recorded with --record.")],
    second: Annotated[Path, typer.Argument(help="Another one.")],
    salvage: Annotated[
        bool, typer.Option(help="Take the intact part of sessions that were cut off.")
    ] = False,
) -> None:
    """Show what differs between two sessions: what was played, their figures, their channels.

    The exit code is 1 if anything does.

    Example: cubeling diff monday.mcap tuesday.mcap
    """
    for path in (first, second):
        check_input(path, "session")
    from cubeling.app.commands.play.complete import complete_session
    from cubeling.app.workshop.inspecting.difference import (
        channel_differences,
        figure_differences,
    )
    from cubeling.app.workshop.inspecting.figures import read_figures

    figures = []
    for path in (first, second):
        with complete_session(path, salvage=salvage) as complete:
            figures.append(read_figures(path, complete, salvage=salvage))
    found = [
        *figure_differences(*figures),
        *channel_differences(first, second, salvage=salvage),
    ]
    console = Console(highlight=False)
    if not found:
        console.print(Text(f"{first.name} and {second.name} hold the same"), soft_wrap=True)
        return
    for word, path in (("first", first), ("second", second)):
        console.print(Text.assemble((f"{word:<6}", "bold"), f"  {path}"), soft_wrap=True)
    table = Table(box=SIMPLE_HEAD)
    table.add_column(overflow="fold", max_width=24)
    for word in ("first", "second"):
        table.add_column(word, overflow="fold", ratio=1)
    for each in found:
        table.add_row(Text(each.what), Text(each.first), Text(each.second))
    console.print(table)
    raise typer.Exit(1)
