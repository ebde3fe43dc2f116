"""Reproduced tables as one page, and each as CSV."""

import csv
from collections.abc import Sequence
from dataclasses import dataclass
from html import escape
from pathlib import Path

from cubeling.app.errors import AppError
from cubeling.app.workshop.reproduction.registry import PrintedTable
from cubeling.app.workshop.reproduction.result import PRINTED, Reproduction, ResultTable
from cubeling.files import whole_file, write_whole

PAGE = "index.html"
"""Name of the page in its folder."""

STYLE = """body { font: 15px/1.5 sans-serif; color: #2b3345; max-width: 76em; margin: 2em auto;
  padding: 0 1em; }
h2 { margin-top: 2.2em; } h2 small { color: #6d7385; font-weight: normal; margin-left: .6em; }
table { border-collapse: collapse; margin: 1em 0; } caption { text-align: left; font-weight: 600; }
td, th { padding: .25em .8em; text-align: right; vertical-align: top; }
th { font-weight: 600; border-bottom: 1px solid #9aa1b2; } tr { border-bottom: 1px solid #dcdfe6; }
td:first-child, th:first-child { text-align: left; } .printed { color: #6d7385; }
.text td, .text th { text-align: left; } .wide { overflow-x: auto; } .missing { color: #6d7385; }
nav a { margin-right: 1.2em; }"""


@dataclass(frozen=True)
class Attempt:
    """A printed table, and what became of it."""

    table: PrintedTable
    """Its entry in the registry."""

    found: Reproduction | None
    """What came out; None if it could not be made."""

    refusal: str = ""
    """The line that says why it could not be made."""


def files_of(attempts: Sequence[Attempt]) -> list[str]:
    """Return the names of the files that are written."""
    return [PAGE, *(name for each in attempts for name, _ in _csv_tables(each))]


def write_report(attempts: Sequence[Attempt], folder: Path) -> None:
    """Write the page and the .csv files into a folder that is there."""
    links = "".join(
        f'<a href="#{each.table.name}">{escape(each.table.name)}</a>' for each in attempts
    )
    body = [
        "<h1>Printed tables, made again</h1>",
        "<p>What four published works print, in grey, beside what this program gives.</p>",
        f"<nav>{links}</nav>",
        *(_section(each) for each in attempts),
    ]
    head = (
        "<!doctype html><html lang=en><meta charset=utf-8>"
        f"<title>Printed tables, made again</title><style>{STYLE}</style>"
    )
    write_whole(folder / PAGE, head + "\n".join(body) + "\n", AppError)
    for attempt in attempts:
        for name, table in _csv_tables(attempt):
            with (
                whole_file(folder / name, AppError) as partial,
                partial.open("w", newline="", encoding="utf-8") as file,
            ):
                csv.writer(file).writerows([table.columns, *table.rows])


def _csv_tables(attempt: Attempt) -> list[tuple[str, ResultTable]]:
    tables = attempt.found.tables if attempt.found else ()
    name = attempt.table.name
    if len(tables) == 1:
        return [(f"{name}.csv", tables[0])]
    return [(f"{name}-{number}.csv", table) for number, table in enumerate(tables, 1)]


def _section(attempt: Attempt) -> str:
    table, found = attempt.table, attempt.found
    head = f"<h2 id={table.name}>{escape(table.title)}<small>{escape(table.source)}</small></h2>"
    if found is None:
        reason = attempt.refusal.removeprefix(f"{table.name}: ")
        return f"{head}<p class=missing>Not made: {escape(reason)}.</p>"
    rows = "".join(_html_table(each) for each in found.tables)
    return (
        f"{head}{rows}<p><b>Made from</b> {escape(found.data)}.</p>"
        f"<p><b>What differs.</b> {escape(found.differs)}</p>"
    )


def _html_table(table: ResultTable) -> str:
    classes = [" class=printed" if c.startswith(PRINTED) else "" for c in table.columns]
    head = "".join(f"<th{c}>{escape(t)}</th>" for c, t in zip(classes, table.columns, strict=True))
    rows = "".join(
        "<tr>"
        + "".join(f"<td{c}>{escape(t)}</td>" for c, t in zip(classes, row, strict=True))
        + "</tr>"
        for row in table.rows
    )
    words = " class=text" if any(len(t) > 40 for row in table.rows for t in row) else ""
    return (
        f"<div class=wide><table{words}><caption>{escape(table.title)}</caption>"
        f"<tr>{head}</tr>{rows}</table></div>"
    )
