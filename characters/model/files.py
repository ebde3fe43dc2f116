"""Reading files that others gave: whole, and never one without an end."""

import os
from pathlib import Path
from stat import S_ISDIR, S_ISREG

from characters.errors import CharacterError

MAX_FILE_BYTES = 1 << 30
"""What is read at most [bytes]; two hours of motion capture at 120 Hz take 0.6 GB."""


def read_file(path: Path, most: int = MAX_FILE_BYTES) -> bytes:
    """Return what is in a file.

    A pipe or a device is refused: to open the one may wait for ever, and the other may not end.

    Raises
    ------
    FileNotFoundError
        If there is no such file: for some it is no mistake. All others see a `CharacterError`
        (`read_required_file`).
    CharacterError
        If it cannot be read, or has more than `most` bytes.
    """
    try:
        found = os.stat(path)
        if not S_ISREG(found.st_mode) and not S_ISDIR(found.st_mode):
            raise CharacterError(f"{path}: a pipe or a device; save it as a file first")
        if found.st_size > most:
            raise CharacterError(
                f"{path}: {found.st_size / 1e6:.0f} MB, of at most {most / 1e6:.0f}; "
                "cut it into pieces"
            )
        return path.read_bytes()
    except FileNotFoundError:
        raise
    except (OSError, ValueError) as error:  # ValueError: a name with a zero byte in it
        reason = getattr(error, "strerror", None) or error
        raise CharacterError(f"{path}: cannot be read ({reason}); check the path") from None


def read_required_file(path: Path, most: int = MAX_FILE_BYTES) -> bytes:
    """Return what is in a file that somebody named, so that it has to be there.

    Raises
    ------
    CharacterError
        As `read_file`, and if there is no such file.
    """
    try:
        return read_file(path, most)
    except FileNotFoundError as error:
        raise CharacterError(f"{path}: cannot be read ({error.strerror}); check the path") from None
