"""Whether a file is a session at all, told before the libraries that read one are loaded."""

import stat
from pathlib import Path
from typing import BinaryIO

from cubeling.app.errors import AppError

MCAP_MAGIC = b"\x89MCAP0\r\n"
"""The first and the last bytes of an MCAP file."""


def open_session_file(path: Path) -> BinaryIO:
    """Open a session; refuse a file that cannot be read or is no session."""
    try:
        if stat.S_ISFIFO(path.stat().st_mode):  # opening one waits for a writer
            raise AppError(f"cannot read the session '{path}': it is a pipe, no file")
        file = path.open("rb")
        start = file.read(len(MCAP_MAGIC))
    except OSError as error:
        raise AppError(f"cannot read the session '{path}': {error.strerror}") from error
    if start != MCAP_MAGIC:
        file.close()
        raise AppError(f"'{path}' is not a session: it does not begin as an .mcap file does")
    return file
