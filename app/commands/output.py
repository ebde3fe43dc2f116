"""The options of commands that write one file."""

from pathlib import Path
from typing import Annotated

import typer

from app.output_path import check_output

OverwriteOption = Annotated[
    bool, typer.Option("--overwrite", help="Overwrite the file of --output if it exists.")
]


def chosen_output(
    given: Path | None, default: str, kind: str, suffixes: tuple[str, ...], overwrite: bool
) -> Path:
    """Return the file to write, or raise AppError: see `check_output`.

    A file of the default name is the program's own, so it is overwritten without `overwrite`.
    """
    path = given or Path(default)
    check_output(path, kind, suffixes, overwrite=overwrite or given is None)
    return path
