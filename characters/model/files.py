"""Reading files with a limit of size, and no pipes or devices."""

import os
from pathlib import Path
from stat import S_ISDIR, S_ISREG

from cubeling.characters.errors import CharacterError

MAX_FILE_BYTES = 1 << 30
"""Two hours of motion capture at 120 Hz take 0.6 GB."""


def read_text(path: Path, max_bytes: int) -> str:
    """Return the text of a file in UTF-8; CharacterError if it is none, and as `read_file`."""
    try:
        return read_file(path, max_bytes).decode()
    except UnicodeDecodeError:
        raise CharacterError(f"{path}: not a text file in UTF-8") from None


def read_file(path: Path, max_bytes: int = MAX_FILE_BYTES) -> bytes:
    """Return the content of a file; refuse pipes and devices, which may never return."""
    try:
        status = os.stat(path)
        if not S_ISREG(status.st_mode) and not S_ISDIR(status.st_mode):
            raise CharacterError(f"{path}: a pipe or a device; save it as a file first")
        if status.st_size > max_bytes:
            raise CharacterError(
                f"{path}: {status.st_size / 1e6:.0f} MB, of at most {max_bytes / 1e6:.0f}; "
                "cut it into pieces"
            )
        return path.read_bytes()
    except (OSError, ValueError) as error:  # ValueError: a zero byte in the name
        reason = getattr(error, "strerror", None) or error
        raise CharacterError(f"{path}: cannot be read ({reason}); check the path") from None
