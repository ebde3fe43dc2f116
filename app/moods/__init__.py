"""Moods of a recorded session: read, computed for other personalities, plotted and tabulated."""

from app.moods.history import Felt, History, felt_by, read_history
from app.moods.table import write_table
from app.moods.wire import Trace, Wire, read_wire

__all__ = [
    "Felt",
    "History",
    "Trace",
    "Wire",
    "felt_by",
    "read_history",
    "read_wire",
    "write_table",
]
