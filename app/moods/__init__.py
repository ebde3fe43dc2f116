"""How a session felt: read from its file, felt again by someone else, drawn, and as a table."""

from app.moods.history import Felt, History, felt_by, read_history
from app.moods.picture import draw
from app.moods.table import write_table
from app.moods.wire import Trace, Wire, read_wire

__all__ = [
    "Felt",
    "History",
    "Trace",
    "Wire",
    "draw",
    "felt_by",
    "read_history",
    "read_wire",
    "write_table",
]
