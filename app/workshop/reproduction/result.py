"""What comes out where a printed table is made again."""

from dataclasses import dataclass

PRINTED = "printed"
"""With this word begin the headings of columns that a work prints."""


@dataclass(frozen=True)
class ResultTable:
    """A table whose columns are the printed figures and ours."""

    title: str
    """Its caption, which names the part that it is."""

    columns: tuple[str, ...]
    """The headings; the first column names the rows."""

    rows: tuple[tuple[str, ...], ...]
    """The cells as text."""


@dataclass(frozen=True)
class Reproduction:
    """A printed table, made again."""

    tables: tuple[ResultTable, ...]
    """The table, in parts where it is large."""

    data: str
    """What it was made from."""

    differs: str
    """What differs from the printed figures, and why."""
