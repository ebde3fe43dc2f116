"""Recorded sessions as tables for a statistics program."""

from app.exporting.columns import CONTEXT, SESSIONS, TABLES, dictionary_rows
from app.exporting.writing import ExportedSession, export

__all__ = ["CONTEXT", "SESSIONS", "TABLES", "ExportedSession", "dictionary_rows", "export"]
