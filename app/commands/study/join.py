"""The command `cubeling join`."""

from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console
from rich.text import Text

from cubeling.app.counted import quantity
from cubeling.app.errors import AppError
from cubeling.app.input_path import check_input
from cubeling.app.output_path import check_output, later_parts
from cubeling.app.ui.literal_text import literal_text


def join(
    first: Annotated[Path, typer.Argument(help="The first file of a recording in parts.")],
    output: Annotated[Path, typer.Option("--output", "-o", help="The .mcap file to write.")],
    overwrite: Annotated[bool, typer.Option("--overwrite", help="Overwrite the file.")] = False,
) -> None:
    """Write a recording in parts as one session, which replays like it.

    The other parts are found beside the first one: day-002.mcap, day-003.mcap … Of a part that was
    cut off, as the program was killed, what can be read is taken.

    Example: cubeling join day.mcap -o whole.mcap
    """
    check_input(first, "session")
    check_output(output, "recording", (".mcap",), overwrite=overwrite)
    if output.exists() and any(output.samefile(part) for part in (first, *later_parts(first))):
        raise AppError("a part itself would be lost: name another file with --output")
    from cubeling.app.session.copying import join_parts

    console = Console(highlight=False, soft_wrap=True)
    count = join_parts(first, output, lambda line: console.print(literal_text(line)))
    console.print(Text.assemble((str(output), "bold"), f" holds {quantity(count, 'part')}"))
