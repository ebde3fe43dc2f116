"""What a printed table is made from again, and what comes out."""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from cubeling.app.errors import AppError
from cubeling.app.workshop.pages.report_table import ReportTable

if TYPE_CHECKING:
    from matplotlib.figure import Figure

PRINTED = "printed"
"""With this word begin the headings of columns that a work prints."""

Progress = Callable[[str], None]
"""Called with what is being done."""


@dataclass(frozen=True)
class ReproductionRequest:
    """What a table may be made from."""

    data: Path | None = None
    """The folder of recordings; None if the user named none."""

    clips: tuple[str, ...] = ()
    """Motions of the user's own, for tables that take them."""

    progress: Progress = lambda what: None

    def folder(self, name: str) -> Path:
        """Return a folder of recordings; raises AppError if it is not there."""
        if self.data is None:
            raise AppError(f"name the folder that holds '{name}' by --data")
        if not (self.data / name).is_dir():
            raise AppError(f"there is no folder '{name}' in '{self.data}'")
        return self.data / name


@dataclass(frozen=True)
class DrawnFigure:
    """A figure of the page."""

    title: str
    """Its number in the work, and what it shows."""

    draw: Callable[["Figure"], None]
    """Fills an empty figure."""

    size_in: tuple[float, float] = (8.8, 3.3)
    """Width and height [in]."""


@dataclass(frozen=True)
class Reproduction:
    """A printed table, made again."""

    tables: tuple[ReportTable, ...]
    """The table, in parts where it is large: its columns are the printed figures and ours."""

    data: str
    """What it was made from."""

    differs: str
    """What differs from the printed figures, and why."""

    plots: tuple[DrawnFigure, ...] = ()
    """The figures that belong to it, which matplotlib draws."""
