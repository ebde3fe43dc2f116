"""Generates the data dictionary of docs/exporting.md from the columns of the export.

`python -m tools.export_dictionary` writes it; a test compares it with the code.
"""

from itertools import groupby
from pathlib import Path

from cubeling.app.workshop.exporting import dictionary_rows
from tools.marked_parts import replace_part

DOCUMENT = Path(__file__).parents[1] / "docs" / "exporting.md"


def updated(document: str) -> str:
    """Return the document with the dictionary of the code."""
    parts = []
    for table, rows in groupby(dictionary_rows(), key=lambda row: row[0]):
        parts += [f"### {table}", "", "| column | unit | files | meaning |", "|---|---|---|---|"]
        parts += [f"| `{row[1]}` | {row[2]} | {row[3]} | {row[4]} |" for row in rows]
        parts.append("")
    return replace_part(document, "dictionary", "\n".join(parts).rstrip())


if __name__ == "__main__":
    DOCUMENT.write_text(updated(DOCUMENT.read_text("utf-8")), "utf-8")
