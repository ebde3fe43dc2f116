"""The command `cubeling inspect`."""

import json
from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console
from rich.table import Table
from rich.text import Text

from cubeling.app.commands.look.character.inspection import inspect_command
from cubeling.app.errors import AppError
from cubeling.app.input_path import check_input
from cubeling.app.output_path import check_output

SESSION_SUFFIX = ".mcap"


def inspect(
    file: Annotated[
        str,
        typer.Argument(help="A session (.mcap), a bundled character, or a file of a character."),
    ],
    output: Annotated[
        Path | None,
        typer.Option(
            "--output", "-o", help="A page (.html) of a session, or a folder for pictures."
        ),
    ] = None,
    as_json: Annotated[
        bool, typer.Option("--json", help="Print the figures of a session as JSON.")
    ] = False,
    overwrite: Annotated[bool, typer.Option("--overwrite", help="Overwrite the page.")] = False,
    salvage: Annotated[
        bool, typer.Option(help="Take the intact part of a session that was cut off.")
    ] = False,
) -> None:
    """Show what is in a file: of a session its rates, gaps, tracking, actions, emotion, link.

    Of a character or a motion, it shows skeleton, size, clips and problems: cubeling character
    inspect has more options for these.

    Example: cubeling inspect recordings/companion.mcap -o companion.html
    """
    path = Path(file)
    if path.suffix != SESSION_SUFFIX:
        if as_json or salvage or overwrite:
            raise AppError("--json, --salvage and --overwrite are for sessions (.mcap)")
        inspect_command(file, output)
        return
    check_input(path, "session")
    if output is not None:
        check_output(output, "page", (".html",), overwrite=overwrite)
    from cubeling.app.commands.play.complete import complete_session
    from cubeling.app.workshop.inspecting.figures import read_figures
    from cubeling.app.workshop.inspecting.summary import document_of, lines_of, page_of
    from cubeling.files import write_whole

    with complete_session(path, salvage=salvage) as complete:
        figures = read_figures(path, complete, salvage=salvage)
    if output is not None:
        write_whole(output, page_of(figures, path), AppError)
    if as_json:
        typer.echo(json.dumps(document_of(figures), indent=2, ensure_ascii=False))
        return
    console = Console(highlight=False)
    table = Table.grid(padding=(0, 2))
    table.add_column(style="bold", no_wrap=True)
    for word, line in lines_of(figures):
        table.add_row(word, Text(line))
    console.print(table)
    if output is not None:
        console.print(Text.assemble("Written: ", (str(output), "bold")), soft_wrap=True)
