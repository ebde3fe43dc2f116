"""The command `cubeling label`."""

from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console
from rich.table import Table
from rich.text import Text

from cubeling.app.input_path import check_input


def label(
    session: Annotated[Path, typer.Argument(help="A session recorded with --record.")],
    participant: Annotated[str | None, typer.Option(help="Code of who played, as P07.")] = None,
    condition: Annotated[str | None, typer.Option(help="The condition of the study.")] = None,
    notes: Annotated[str | None, typer.Option(help="A note on the session.")] = None,
    mark: Annotated[
        list[str] | None,
        typer.Option(
            help="A moment: seconds from the first frame, and a name, as '12.5 error: fell'. "
            "Repeatable."
        ),
    ] = None,
) -> None:
    """Say who played a recorded session, and mark moments in it; the recording stays as it was.

    What is given is kept beside the session, in NAME.labels.toml, and counts for every command.
    Without an option, all labels and marks are shown.

    Example: cubeling label anna.mcap --participant P07 --mark "12.5 error: the cube fell"
    """
    check_input(session, "session")
    from dataclasses import replace

    from cubeling.app.session import SessionFile, with_mark, write_labels

    console = Console(highlight=False, soft_wrap=True)
    with SessionFile(session) as file:
        labels = file.info.labels
        given = {"participant": participant, "condition": condition, "notes": notes}
        changes = {name: text for name, text in given.items() if text is not None}
        if changes or mark:
            labels = replace(labels, **changes)  # type: ignore[arg-type] # marks are no text
            for text in mark or ():
                labels = with_mark(labels, text, file.info.duration)
            path = write_labels(session, labels)
            console.print(Text(f"Kept in {path}; {session.name} is as it was"))
            return
        table = Table.grid(padding=(0, 2))
        for name in given:
            table.add_row(name, Text(getattr(labels, name) or "–"))
        for moment in file.marks:
            table.add_row(f"{moment.at_s:.1f} s", Text(moment.words))
        console.print(table)
