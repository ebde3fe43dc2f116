"""The command `cubeling reproduce`."""

import time
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer
from rich.console import Console
from rich.markup import escape
from rich.table import Table

from cubeling.app.errors import AppError
from cubeling.app.input_path import check_motions
from cubeling.app.output_path import check_output_folder, output_folder

if TYPE_CHECKING:
    from cubeling.app.workshop.pages.report_table import ReportTable
    from cubeling.app.workshop.reproduction.page import Attempt


def reproduce(
    names: Annotated[
        list[str] | None, typer.Argument(help="Tables by name; without any, all of them.")
    ] = None,
    output: Annotated[
        Path | None,
        typer.Option("--output", "-o", help="Folder for a page of all tables, and .csv files."),
    ] = None,
    data: Annotated[
        Path | None,
        typer.Option(help="The folder of recordings that some tables need, such as cmu-mocap."),
    ] = None,
    clips: Annotated[
        list[str] | None,
        typer.Option(
            "--clip",
            help="For motion-graphs, a motion of your own; give four: a walk, a run, a walk with "
            "long steps, a slow walk; or several choices of four.",
        ),
    ] = None,
    listing: Annotated[
        bool, typer.Option("--list", help="List the tables, and what each needs.")
    ] = False,
    overwrite: Annotated[
        bool, typer.Option("--overwrite", help="Overwrite an earlier page.")
    ] = False,
) -> None:
    """Make printed tables and figures of the theses again, beside what they print.

    A table that cannot be made says why: some need recordings, some were made from what nobody
    published. The plots of the page need matplotlib.

    Example: cubeling reproduce ik-methods gesture-graph -o report
    """
    from cubeling.app.workshop.reproduction.page import Attempt, files_of, write_report
    from cubeling.app.workshop.reproduction.registry import chosen_tables
    from cubeling.app.workshop.reproduction.result import ReproductionRequest

    console = Console()
    tables = chosen_tables(names or ())
    if listing:
        for table in tables:
            needs = table.missing or (f"needs {', '.join(table.needs)}" if table.needs else "")
            console.print(f"[bold]{table.name}[/]: {escape(table.title)} ({escape(table.source)})")
            if needs:
                console.print(f"    {escape(needs)}", style="dim", highlight=False)
        return
    if data is not None and not data.is_dir():
        raise AppError(f"there is no folder '{data}'")
    check_motions(clips or ())
    if output is not None:
        expected = [Attempt(table, None) for table in tables]
        check_output_folder(output, files_of(expected), "reproduced tables", overwrite=overwrite)
    attempts = []
    with console.status("") as status:
        for table in tables:

            def report(what: str, name: str = table.name) -> None:
                status.update(f"{name}: {what}")

            report("…")
            begin, worked = time.perf_counter(), time.process_time()
            try:
                found = table.reproduce(ReproductionRequest(data, tuple(clips or ()), report))
                times = time.perf_counter() - begin, time.process_time() - worked
                attempts.append(Attempt(table, found, "", *times))
            except AppError as error:
                if names:
                    raise
                attempts.append(Attempt(table, None, str(error)))
    for attempt in attempts:
        _show(console, attempt)
    if output is not None:
        with output_folder(output):
            write_report(attempts, output)
        page = output / files_of(attempts)[0]
        console.print(f"[bold]{escape(str(page))}[/] is written", soft_wrap=True, highlight=False)


def _show(console: Console, attempt: "Attempt") -> None:
    """Print what became of a table."""
    table, found = attempt.table, attempt.found
    console.print(f"[bold]{escape(table.source)}[/]: {escape(table.title)}", highlight=False)
    if found is None:
        console.print(f"not made: {escape(attempt.refusal)}\n", style="dim", highlight=False)
        return
    for each in found.tables:
        console.print(shown_table(each))
    console.print(f"Made from {escape(found.data)}, in {attempt.cost}.", highlight=False)
    console.print(f"What differs: {escape(found.differs)}\n", highlight=False)


def shown_table(table: "ReportTable") -> Table:
    """Return a table for a terminal of 80 columns; what is printed is dim."""
    shown = Table(
        title=escape(table.title),
        title_justify="left",
        title_style="bold",
        box=None,
        pad_edge=False,
        padding=(0, 1, 0, 0),
    )
    for number, column in enumerate(table.columns):
        dim = "dim" if column.startswith("printed") else ""
        width = max(len(row[number]) for row in table.rows)
        words = width > 20
        shown.add_column(
            escape(column),
            justify="right" if number and not words else "left",
            style=dim,
            min_width=0 if number else width,
        )
    for row in table.rows:
        shown.add_row(*(escape(cell) for cell in row))
    return shown
