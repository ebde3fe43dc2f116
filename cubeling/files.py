"""The one way to open a file of a person: regular files, of a limited size, whole when written.

Who reads a kind of file states it as a `FileKind`, with the function that reads one. So there is a
list of all readers (`KINDS`), and `tests.campaigns.files` feeds each of them damaged files.
"""

import io
import os
import stat
from collections.abc import Collection, Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path
from typing import BinaryIO

from cubeling.bad_input import one_line

KINDS: list["FileKind"] = []
"""Every kind of file whose module is loaded."""

_MOST_AT_ONCE = 1 << 16
_BLOCKED_OPEN = getattr(os, "O_NONBLOCK", 0)  # Windows has neither this nor pipes among files


@dataclass(frozen=True)
class FileKind:
    """A kind of file that the program reads.

    >>> notes = FileKind("note", (".txt",), ValueError, 1000, "pathlib:Path.read_text")
    >>> notes.read("missing.txt")
    Traceback (most recent call last):
        ...
    ValueError: cannot read the note 'missing.txt': No such file or directory
    >>> KINDS.remove(notes)
    """

    name: str
    """How messages call such a file: "cube", "motion graph"."""

    suffixes: Collection[str]
    """The suffixes by which it is known, in lower case with their dot."""

    error: type[Exception]
    """The class of the errors: that of the room."""

    max_bytes: int
    """Largest file that is read [bytes]."""

    reader: str
    """The function that takes a path and returns what the file holds: "package.module:name"."""

    def __post_init__(self) -> None:
        KINDS.append(self)

    def open(self, path: str | Path) -> BinaryIO:
        """Open a file for reading.

        Raises
        ------
        error
            If it cannot be opened, is no regular file (a pipe or a device may never end), or is
            larger than `max_bytes`.
        """
        # Looking comes first: to open some devices does something, such as to reset a robot.
        check_regular(path, self.name, self.error)
        try:
            file = _OpenFile(io.FileIO(path, opener=_open_at_once))
        except OSError as cause:
            raise self._refusal(path, cause.strerror or str(cause)) from None
        size = os.fstat(file.fileno()).st_size
        if size > self.max_bytes:
            file.close()
            most = f"of at most {_amount(self.max_bytes)}"
            raise self._refusal(path, f"it has {_amount(size)}, {most}")
        return file

    def check(self, path: str | Path) -> None:
        """Refuse what `open` refuses, for a library that opens files by itself."""
        self.open(path).close()

    def read(self, path: str | Path) -> bytes:
        """Return the content of a file; see `open` for what is refused."""
        with self.open(path) as file:
            try:
                data = file.read(self.max_bytes + 1)
            except OSError as cause:
                raise self._refusal(path, cause.strerror or str(cause)) from None
        if len(data) > self.max_bytes:  # it grows, or its size is not known
            raise self._refusal(path, f"it has more than {_amount(self.max_bytes)}")
        return data

    def read_text(self, path: str | Path) -> str:
        """Return the text of a file in UTF-8; `error` if it is none, and as `read`."""
        try:
            return self.read(path).decode("utf-8-sig")
        except UnicodeDecodeError as cause:
            reason = f"it is not UTF-8 (byte {cause.start}); save it as that"
            raise self._refusal(path, reason) from None

    def _refusal(self, path: str | Path, reason: str) -> Exception:
        return _unreadable(path, self.name, reason, self.error)


def check_regular(path: str | Path, name: str, error: type[Exception]) -> None:
    """Refuse what is not there or is no regular file; `name` says what it is, as in `FileKind`."""
    try:
        is_file = stat.S_ISREG(os.stat(path).st_mode)
    except (OSError, ValueError) as cause:  # ValueError: a name that no file can have
        reason = getattr(cause, "strerror", None) or str(cause)
        raise _unreadable(path, name, reason, error) from None
    if not is_file:
        reason = "it is a folder, a pipe or a device; give a file"
        raise _unreadable(path, name, reason, error)


def is_there(path: str | Path) -> bool:
    """Return whether a path leads to something; False where it is no possible path.

    `Path.exists` raises an error for a name that is too long, or in a folder that may not be read.

    >>> is_there("x" * 5000)
    False
    """
    try:
        return Path(path).exists()
    except OSError:
        return False


def first_bytes(path: str | Path, count: int) -> bytes:
    """Return how a regular file begins, by which its format is known; b"" if it cannot be read."""
    try:
        check_regular(path, "file", OSError)
        with _OpenFile(io.FileIO(path, opener=_open_at_once)) as file:
            return file.read(count)
    except OSError:
        return b""


def _unreadable(path: str | Path, name: str, reason: str, error: type[Exception]) -> Exception:
    return error(f"cannot read the {name} '{one_line(str(path))}': {reason}")


@contextmanager
def whole_file(path: str | Path, error: type[Exception]) -> Iterator[Path]:
    """Yield the path to write a file at until it is whole: `NAME.partial`, with the same suffix.

    Leaving the block renames it. Leaving it with an error, such as Ctrl-C, removes it and leaves a
    file of that name as it was.

    Raises
    ------
    error
        If it cannot be written, as on a full disk; the line names the file.
    """
    target = Path(os.path.realpath(path))  # what a link points to: the link stays one
    partial = target.with_name(f"{target.stem}.partial{target.suffix}")
    try:
        yield partial
        os.replace(partial, target)
    except OSError as cause:
        reason = cause.strerror or str(cause)
        raise error(f"cannot write '{one_line(str(path))}': {reason}") from cause
    finally:
        with suppress(OSError):  # a folder that is none
            partial.unlink(missing_ok=True)


def write_whole(path: str | Path, content: str | bytes, error: type[Exception]) -> None:
    """Write a file completely or not at all; see `whole_file`. A text is written in UTF-8."""
    with whole_file(path, error) as partial:
        partial.write_bytes(content.encode() if isinstance(content, str) else content)


class _OpenFile(io.BufferedReader):
    """A file that takes no more memory to read than it has bytes, whatever it is asked for.

    Python sets the memory aside before it reads, and a damaged length may ask for gigabytes.
    """

    def read(self, size: int | None = -1, /) -> bytes:
        if size is None or size < _MOST_AT_ONCE:
            return super().read(size)
        parts = []
        while size > 0 and (part := super().read(min(size, self._next_bytes()))):
            parts.append(part)
            size -= len(part)
        return b"".join(parts)

    def _next_bytes(self) -> int:
        return max(_MOST_AT_ONCE, os.fstat(self.fileno()).st_size - self.tell())


def _open_at_once(path: str, flags: int) -> int:
    """Open a file without waiting, should it have become a pipe since it was looked at."""
    return os.open(path, flags | _BLOCKED_OPEN, 0o666)


def _amount(size: int) -> str:
    """Return a number of bytes in a unit that suits it.

    >>> _amount(65_536), _amount(1 << 30)
    ('65.5 kB', '1.07 GB')
    """
    for unit, factor in (("GB", 1e9), ("MB", 1e6), ("kB", 1e3)):
        if size >= factor:
            return f"{size / factor:.3g} {unit}"
    return f"{size} bytes"
