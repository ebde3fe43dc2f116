"""Recorded sessions as tables for a statistics program."""

from cubeling.app.workshop.exporting.columns import (
    CONTEXT_COLUMNS,
    EXPORT_TABLES,
    SESSION_COLUMNS,
    dictionary_rows,
)
from cubeling.app.workshop.exporting.writing import ExportedSession, export

__all__ = [
    "CONTEXT_COLUMNS",
    "EXPORT_TABLES",
    "SESSION_COLUMNS",
    "ExportedSession",
    "dictionary_rows",
    "export",
]
