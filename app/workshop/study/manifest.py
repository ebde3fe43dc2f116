"""The table beside the stimuli of a study that says what each file shows."""

import csv
from collections.abc import Mapping, Sequence
from pathlib import Path

from cubeling.app.errors import AppError
from cubeling.files import whole_file

MANIFEST = "manifest.csv"


def write_rows(path: Path, rows: Sequence[Mapping[str, str]]) -> None:
    """Write rows of the same columns as CSV; raises AppError."""
    with (
        whole_file(path, AppError) as partial,
        partial.open("w", encoding="utf-8", newline="") as file,
    ):
        writer = csv.DictWriter(file, list(rows[0]) if rows else [])
        writer.writeheader()
        writer.writerows(rows)
