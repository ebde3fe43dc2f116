"""The command `cubeling anonymise`."""

from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console
from rich.text import Text

from cubeling.app.counted import quantity
from cubeling.app.errors import AppError
from cubeling.app.input_path import check_input
from cubeling.app.output_path import check_output


def anonymise(
    session: Annotated[Path, typer.Argument(help="A session recorded with --record.")],
    output: Annotated[Path, typer.Option("--output", "-o", help="The .mcap file to write.")],
    overwrite: Annotated[bool, typer.Option("--overwrite", help="Overwrite the file.")] = False,
) -> None:
    """Blur the pictures of a session outside the cubes and the table around them.

    All other channels stay. Where no cube was found, the whole picture is blurred. Look at the
    result before you give it away: a hand or a sleeve at the cube stays sharp.

    Example: cubeling anonymise anna.mcap -o shared.mcap
    """
    check_input(session, "session")
    check_output(output, "recording", (".mcap",), overwrite=overwrite)
    if output.exists() and output.samefile(session):
        raise AppError("the session itself would be lost: name another file with --output")
    from cubeling.app.commands.play.complete import complete_session
    from cubeling.app.session import SessionFile
    from cubeling.app.workshop.anonymising import anonymise as write_anonymised

    with SessionFile(session) as file:
        edge = file.cube_edge
    with complete_session(session) as complete:
        count = write_anonymised(complete, output, edge)
    console = Console(highlight=False, soft_wrap=True)
    console.print(Text.assemble((str(output), "bold"), f": {quantity(count, 'picture')} blurred"))
