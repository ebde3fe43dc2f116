"""The options of commands that write one file."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Annotated

import typer

from cubeling.app.errors import AppError
from cubeling.app.output_path import check_output
from cubeling.app.ui.output_formats import ENCODERS

OverwriteOption = Annotated[
    bool, typer.Option("--overwrite", help="Overwrite the file of --output if it exists.")
]

VideoCodecOption = Annotated[
    str,
    typer.Option("--codec", help=f"What encodes a video: auto, {', '.join(list(ENCODERS)[:-1])}."),
]

PLOT_SUFFIXES = (".svg", ".pdf", ".png")
"""Suffixes of the files that a plot can be written to."""


PlotOption = Annotated[
    Path | None, typer.Option("--output", "-o", help="Plot to this .svg, .pdf or .png file.")
]


@contextmanager
def needs_matplotlib() -> Iterator[None]:
    """Import what draws plots within; without matplotlib, an AppError says what to install."""
    try:
        yield
    except ImportError as error:
        if (error.name or "").split(".")[0] != "matplotlib":
            raise
        raise AppError("a plot needs matplotlib: pip install matplotlib") from error


def chosen_output(
    given: Path | None, default: str, kind: str, suffixes: tuple[str, ...], overwrite: bool
) -> Path:
    """Return the file to write, or raise AppError: see `check_output`.

    A file of the default name is the program's own, so it is overwritten without `overwrite`.
    """
    path = given or Path(default)
    check_output(path, kind, suffixes, overwrite=overwrite or given is None)
    return path
