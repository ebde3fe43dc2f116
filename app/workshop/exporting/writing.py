"""Writing the tables of recorded sessions as CSV and as JSON Lines."""

import csv
import json
import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import ExitStack
from dataclasses import dataclass, replace
from pathlib import Path
from typing import IO, Any

import numpy as np

from cubeling.app.errors import AppError
from cubeling.app.session import SessionFile, SessionInfo, session_info
from cubeling.app.session.encoding import CHANNEL_TYPES, decode
from cubeling.app.workshop.exporting.column import Cell, Column, Table
from cubeling.app.workshop.exporting.columns import (
    CONTEXT_COLUMNS,
    EXPORT_TABLES,
    SESSION_COLUMNS,
    SESSION_CONTEXT_COLUMNS,
    dictionary_rows,
)
from cubeling.files import whole_file

DICTIONARY_FILE = "data_dictionary.csv"
DICTIONARY_COLUMNS = ("table", "column", "unit", "files", "meaning")

EXPORT_FILES = (
    *(f"{name}.{suffix}" for name in ("sessions", *(table.name for table in EXPORT_TABLES))
      for suffix in ("csv", "jsonl")),
    DICTIONARY_FILE,
)  # fmt: skip
"""Names of all files of an export."""


@dataclass(frozen=True)
class ExportedSession:
    """A session to export, and its labels."""

    path: Path

    info: SessionInfo
    """What it says of itself."""

    complete: Path | None = None
    """The same session with every channel; None if its own file has them."""

    @classmethod
    def read(
        cls, path: Path, participant: str = "", condition: str = "", *, salvage: bool = False
    ) -> "ExportedSession":
        """Read what a session says of itself; raises AppError as `session_info` does.

        A participant or a condition replaces the one that it says.
        """
        info = session_info(path, salvage=salvage)
        labels = replace(
            info.labels,
            participant=participant or info.labels.participant,
            condition=condition or info.labels.condition,
        )
        return cls(path, replace(info, labels=labels))

    def with_channels(self, complete: Path) -> "ExportedSession":
        """Return the same session with a file that has every channel, and says what it plays."""
        played = self.info.played or session_info(complete, salvage=True).played
        return replace(self, complete=complete, info=replace(self.info, played=played))

    @property
    def labels(self) -> tuple[str, str, str]:
        """The first cells of its rows."""
        labels = self.info.labels
        return self.path.stem, labels.participant, labels.condition


def export(sessions: Sequence[ExportedSession], folder: Path) -> dict[str, int]:
    """Write all tables of some sessions, and return the number of rows of each table.

    Existing files are overwritten when all tables are whole; after an error they are as they were.

    Raises
    ------
    AppError
        A message cannot be read, or a file cannot be written.
    """
    with ExitStack() as closing:
        places = {name: whole_file(folder / name, AppError) for name in EXPORT_FILES}
        files = {name: closing.enter_context(place) for name, place in places.items()}
        return _write_all(sessions, files)


def _write_all(sessions: Sequence[ExportedSession], files: Mapping[str, Path]) -> dict[str, int]:
    """Write every file, and return the number of rows of each table."""
    with _create(files[DICTIONARY_FILE]) as file:
        csv.writer(file).writerows([DICTIONARY_COLUMNS, *dictionary_rows()])
    about = SESSION_CONTEXT_COLUMNS + SESSION_COLUMNS
    rows = {"sessions": _write(files, "sessions", about, _session_rows(sessions))}
    for table in EXPORT_TABLES:
        columns = CONTEXT_COLUMNS + table.columns
        rows[table.name] = _write(files, table.name, columns, _table_rows(sessions, table))
    return rows


def _session_rows(sessions: Sequence[ExportedSession]) -> Iterator[list[Cell]]:
    for session in sessions:
        cells = [column.value(session.info) for column in SESSION_COLUMNS]
        yield [*(column.value(session.labels) for column in SESSION_CONTEXT_COLUMNS), *cells]


def _table_rows(sessions: Sequence[ExportedSession], table: Table) -> Iterator[list[Cell]]:
    for session in sessions:
        with SessionFile(session.complete or session.path) as file:
            found = _messages(session, file, table) if table.read is None else table.read(file)
            for time, message in found:
                cells = [column.value(message) for column in table.columns]
                context = (*session.labels, time)
                yield [*(column.value(context) for column in CONTEXT_COLUMNS), *cells]


def _messages(
    session: ExportedSession, file: SessionFile, table: Table
) -> Iterator[tuple[float, Any]]:
    """Yield the messages of a table's topic, with their times [s]."""
    for topic, time, data in file.messages(table.topic):
        try:
            kind = CHANNEL_TYPES.get(topic)
            yield time, json.loads(data) if kind is None else decode(kind, data)
        except ValueError as error:
            raise AppError(
                f"cannot read the session '{session.path}': {topic} at {time:.3f} s: {error}"
            ) from error


def _write(
    files: Mapping[str, Path], name: str, columns: Sequence[Column], rows: Iterable[list[Cell]]
) -> int:
    """Write one table as CSV and as JSON Lines, row by row, and return the number of rows."""
    flat = [index for index, column in enumerate(columns) if not column.nested]
    names = [column.name for column in columns]
    count = 0
    with ExitStack() as closing:
        table, lines = (
            closing.enter_context(_create(files[f"{name}.{suffix}"])) for suffix in ("csv", "jsonl")
        )
        writer = csv.writer(table)
        writer.writerow([names[index] for index in flat])
        for row in rows:
            cells = [_plain(cell) for cell in row]
            writer.writerow([_text(cells[index]) for index in flat])
            document = dict(zip(names, cells, strict=True))
            lines.write(json.dumps(document, ensure_ascii=False, allow_nan=False) + "\n")
            count += 1
    return count


def _create(path: Path) -> IO[str]:
    return path.open("w", encoding="utf-8", newline="")


def _plain(cell: Cell) -> Any:
    """Return a cell as JSON can hold it; a number that is not finite is unknown."""
    if isinstance(cell, np.ndarray):
        numbers = cell.astype(object)
        numbers[~np.isfinite(cell)] = None
        return numbers.tolist()
    if isinstance(cell, float | np.floating):
        return float(cell) if math.isfinite(cell) else None
    return cell


def _text(cell: Any) -> str:
    """Return a cell of a CSV file; an unknown one is empty."""
    if cell is None:
        return ""
    if isinstance(cell, bool):
        return str(int(cell))
    return str(cell)
