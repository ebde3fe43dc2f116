"""Reproduced tables as one page, and each as CSV."""

import csv
from collections.abc import Sequence
from dataclasses import dataclass
from html import escape
from importlib.util import find_spec
from pathlib import Path

from cubeling.app.errors import AppError
from cubeling.app.workshop.pages.page import heading, page, paragraph, table
from cubeling.app.workshop.pages.report_table import ReportTable
from cubeling.app.workshop.reproduction.registry import PrintedTable
from cubeling.app.workshop.reproduction.result import PRINTED, DrawnFigure, Reproduction
from cubeling.files import whole_file, write_whole

PAGE = "index.html"
"""Name of the page in its folder."""

TITLE = "Printed tables, made again"

NO_MATPLOTLIB = "Plots need matplotlib: pip install matplotlib"

LONG_CELL = 40
"""Letters from which on a cell is a text that wraps."""


@dataclass(frozen=True)
class Attempt:
    """A printed table, and what became of it."""

    table: PrintedTable
    """Its entry in the registry."""

    found: Reproduction | None
    """What came out; None if it could not be made."""

    refusal: str = ""
    """The line that says why it could not be made."""

    seconds: float = 0.0
    """How long it took on the clock [s]."""

    cpu_seconds: float = 0.0
    """How long processors worked for it [s]."""

    @property
    def cost(self) -> str:
        """How long it took, in words."""
        return f"{duration(self.seconds)} ({duration(self.cpu_seconds)} of processor time)"


def files_of(attempts: Sequence[Attempt]) -> list[str]:
    """Return the names of the files that are written."""
    return [PAGE, *(name for each in attempts for name, _ in _csv_tables(each))]


def write_report(attempts: Sequence[Attempt], folder: Path) -> None:
    """Write the page and the .csv files into a folder that is there."""
    made = sum(each.found is not None for each in attempts)
    total = sum(each.seconds for each in attempts)
    parts = [
        heading(TITLE, 1),
        paragraph(
            "What three theses print, in grey, beside what this program gives. "
            f"{made} of {len(attempts)} could be made here, in {duration(total)}."
        ),
        _contents(attempts),
        *(part for each in attempts for part in _section(each)),
    ]
    write_whole(folder / PAGE, page(TITLE, parts), AppError)
    for attempt in attempts:
        for name, own in _csv_tables(attempt):
            with (
                whole_file(folder / name, AppError) as partial,
                partial.open("w", newline="", encoding="utf-8") as file,
            ):
                csv.writer(file).writerows([own.columns, *own.rows])


def duration(seconds: float) -> str:
    """Return a time in words.

    >>> duration(0.04), duration(3.21), duration(31.2), duration(247.0)
    ('less than 0.1 s', '3.2 s', '31 s', '4.1 min')
    """
    if seconds < 0.1:
        return "less than 0.1 s"
    if seconds >= 100.0:
        return f"{seconds / 60.0:.1f} min"
    return f"{seconds:.0f} s" if seconds >= 10.0 else f"{seconds:.2g} s"


def _csv_tables(attempt: Attempt) -> list[tuple[str, ReportTable]]:
    tables = attempt.found.tables if attempt.found else ()
    name = attempt.table.name
    if len(tables) == 1:
        return [(f"{name}.csv", tables[0])]
    return [(f"{name}-{number}.csv", each) for number, each in enumerate(tables, 1)]


def _contents(attempts: Sequence[Attempt]) -> str:
    """Return a list of all tables by work, with links."""
    works: dict[str, list[Attempt]] = {}
    for each in attempts:
        works.setdefault(each.table.work, []).append(each)
    lists = []
    for work, own in works.items():
        lines = "".join(
            f'<li><a href="#{each.table.name}">{escape(each.table.printed_in)}</a>: '
            f"{escape(each.table.title)}{'' if each.found else ' (not made)'}</li>"
            for each in own
        )
        lists.append(f"<h3>{escape(work)}</h3><ul>{lines}</ul>")
    return f"<nav>{''.join(lists)}</nav>"


def _section(attempt: Attempt) -> list[str]:
    own, found = attempt.table, attempt.found
    title = f'<h2 id="{own.name}">{escape(own.title)}</h2>'
    parts = [title, paragraph(f"{own.source}: cubeling reproduce {own.name}", "note")]
    if found is None:
        shown = [] if own.printed is None else [_table(own.printed)]
        reason = attempt.refusal.removeprefix(f"{own.name}: ")
        return [*parts, *shown, paragraph(f"Not made: {reason}.", "warning")]
    parts += [_table(each) for each in found.tables]
    parts += _plots(found.plots)
    for words, text in (("Made from", f"{found.data}."), ("What differs.", found.differs)):
        parts.append(f"<p><b>{words}</b> {escape(text)}</p>")
    return [*parts, paragraph(f"It took {attempt.cost} here.", "note")]


def _table(content: ReportTable) -> str:
    words = any(len(cell) > LONG_CELL for row in content.rows for cell in row)
    return table(content, words=words, quiet=PRINTED)


def _plots(plots: Sequence[DrawnFigure]) -> list[str]:
    if not plots:
        return []
    if find_spec("matplotlib") is None:
        return [paragraph(NO_MATPLOTLIB, "note")]
    from cubeling.app.workshop.reproduction.plots import inline_svg

    return [
        f"<figure>{inline_svg(each)}<figcaption>{escape(each.title)}</figcaption></figure>"
        for each in plots
    ]
