"""Whether a file is a session at all, told before the libraries that read one are loaded."""

from pathlib import Path
from typing import BinaryIO

from cubeling.app.errors import AppError
from cubeling.files import FileKind

MCAP_MAGIC = b"\x89MCAP0\r\n"
"""The first and the last bytes of an MCAP file."""


SESSION_FILE = FileKind(
    "session", (".mcap",), AppError, 1 << 40, "cubeling.app.session.session_file:SessionFile"
)
"""A session; it is read message by message, so its size does not matter."""


def open_session_file(path: Path) -> BinaryIO:
    """Open a session; refuse a file that cannot be read or is no session."""
    file = SESSION_FILE.open(path)
    start = file.read(len(MCAP_MAGIC))
    if start != MCAP_MAGIC:
        file.close()
        raise AppError(f"'{path}' is not a session: it does not begin as an .mcap file does")
    return file
