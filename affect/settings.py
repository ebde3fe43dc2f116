"""Reads TOML files of personalities and robot settings, and validates their values."""

import math
import stat
import tomllib
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from cubeling.affect.errors import AffectError

MAX_FILE_BYTES = 65_536
"""Largest file [bytes]; a larger one was not written by hand."""

MAX_LINE_CHARS = 2000
"""Longest line [characters]: `tomllib` takes half a minute for `a.a.a…` of 65 kB
(`test_a_file_made_to_keep_us_busy_is_refused_at_once`)."""

MAX_ENTRIES = 64
"""Most entries of a list, or of a table with free keys."""

MAX_KEY_BYTES = 64
"""Longest free key [bytes of UTF-8], unless the caller sets a lower limit."""

MAX_SHOWN_CHARS = 60
"""Most characters of a wrong value or key in a message."""


def read(path: Path, error: type[Exception] = AffectError) -> dict[str, Any]:
    """Return the content of a TOML file.

    Raises
    ------
    error
        If it cannot be read, is no regular file (a device or a pipe may never end), or is not TOML.
    """
    source = printable(str(path))
    try:
        if not stat.S_ISREG(path.stat().st_mode):
            raise error(f"cannot read {source}: it is no file")
        with path.open("rb") as file:
            data = file.read(MAX_FILE_BYTES + 1)
    except (OSError, ValueError) as cause:  # ValueError: a name that no file can have
        reason = getattr(cause, "strerror", None) or cause
        raise error(f"cannot read {source}: {reason}") from None
    if len(data) > MAX_FILE_BYTES:
        raise error(f"{source}: larger than {MAX_FILE_BYTES} bytes; nobody wrote that by hand")
    try:
        return parse(data.decode("utf-8-sig"), source, error)
    except UnicodeDecodeError as cause:
        raise error(f"{source}: not UTF-8 (byte {cause.start}); save it as that") from None


def parse(text: str, source: str, error: type[Exception] = AffectError) -> dict[str, Any]:
    """Return the content of a TOML text; `source` is its name in messages."""
    if max(map(len, text.split("\n"))) > MAX_LINE_CHARS:
        raise error(f"{source}: a line has more than {MAX_LINE_CHARS} characters; break it")
    try:
        return tomllib.loads(text)
    except RecursionError:
        raise error(f"{source}: not TOML that can be read: too deeply nested") from None
    except ValueError as cause:  # not TOML, or a number with thousands of digits
        raise error(f"{source}: not TOML: {printable(str(cause))}") from None


def printable(text: str) -> str:
    """Return a text that can be printed in one line."""
    return text if text.isprintable() else repr(text)


class TomlTable:
    """A table of a file; its methods return validated values.

    Every method raises `error` for a wrong value, and for a missing one without a default.

    Parameters
    ----------
    values
        The content.
    source
        Name of the file, for messages.
    place
        The keys of the table, "moods.happy"; empty for the whole file.
    error
        The class of the errors.
    """

    def __init__(
        self,
        values: Mapping[str, Any],
        source: str,
        place: str = "",
        error: type[Exception] = AffectError,
    ) -> None:
        self._error_class = error
        self._values = values
        self._source = printable(source)
        self._place = place

    def __contains__(self, key: str) -> bool:
        return key in self._values

    def only(self, *keys: str) -> None:
        """Refuse all other keys."""
        for key in self._values:
            if key not in keys:
                raise self._error(key, f" means nothing here; there are {', '.join(keys)}")

    def names(self, longest: int = MAX_KEY_BYTES) -> list[str]:
        """Return the keys of a table with free keys, each at most `longest` bytes of UTF-8."""
        if len(self._values) > MAX_ENTRIES:
            count = len(self._values)
            raise self.wrong("", f"must have at most {MAX_ENTRIES} entries, not {count}")
        for key in self._values:
            if not key or not key.isprintable() or len(key.encode()) > longest:
                raise self.wrong(key, f"a name has 1 to {longest} bytes, all of them printable")
        return list(self._values)

    def table(self, key: str, *keys: str) -> "TomlTable":
        """Return a subtable, empty if missing; only `keys` are allowed in it, if any are given."""
        value = self._values.get(key, {})
        if not isinstance(value, Mapping):
            raise self.unlike(key, f"a table{' of ' if keys else ''}{', '.join(keys)}")
        table = TomlTable(value, self._source, self._at(key), self._error_class)
        if keys:
            table.only(*keys)
        return table

    def tables(self, key: str, *keys: str, longest: int = MAX_KEY_BYTES) -> dict[str, "TomlTable"]:
        """Return the subtables of a subtable with free keys."""
        table = self.table(key)
        return {name: table.table(name, *keys) for name in table.names(longest)}

    def text(self, key: str, default: str | None = None) -> str:
        """Return a text; raise AffectError if it is another type, or missing without a default."""
        value = self._values.get(key, default)
        if not isinstance(value, str):
            raise self.unlike(key, "a text")
        return value

    def number(
        self, key: str, low: float = -math.inf, high: float = math.inf, default: float | None = None
    ) -> float:
        """Return a number from `low` to `high`; never NaN."""
        value = self._values.get(key, default)
        allowed = "a number" + (f" from {low:g} to {high:g}" if math.isfinite(high - low) else "")
        if type(value) not in (int, float) or not low <= value <= high:  # refuses NaN and true
            raise self.unlike(key, allowed)
        try:
            return float(value)
        except OverflowError:
            raise self.unlike(key, allowed) from None

    def whole(self, key: str, low: int, high: int, default: int | None = None) -> int:
        """Return a whole number from `low` to `high`."""
        value = self._values.get(key, default)
        if type(value) is not int or not low <= value <= high:
            raise self.unlike(key, f"a whole number from {low} to {high}")
        return value

    def truth(self, key: str, default: bool) -> bool:
        """Return true or false."""
        value = self._values.get(key, default)
        if not isinstance(value, bool):
            raise self.unlike(key, "true or false")
        return value

    def list(self, key: str, of: str) -> list[Any]:
        """Return a list, empty if missing; `of` describes its entries in messages."""
        value = self._values.get(key, [])
        if not isinstance(value, list) or len(value) > MAX_ENTRIES:
            raise self.unlike(key, f"a list of at most {MAX_ENTRIES} {of}")
        return value

    def texts(self, key: str, default: tuple[str, ...] = ()) -> tuple[str, ...]:
        """Return a list of printable texts that are not empty."""
        if key not in self._values:
            return default
        for text in self.list(key, "texts"):
            if not isinstance(text, str) or not text.strip() or not text.isprintable():
                raise self.unlike(key, "texts that can be printed, none of them empty", text)
        return tuple(self._values[key])

    def wrong(self, key: str, why: str) -> Exception:
        """Return the error for a key of the file, with the reason."""
        return self._error(key, f": {why}")

    def unlike(self, key: str, allowed: str, value: object = None) -> Exception:
        """Return the error for a value that is not allowed; None for the value of the key."""
        if key not in self._values:
            return self._error(key, f" is missing; it must be {allowed}")
        given = excerpt(self._values[key] if value is None else value)
        return self._error(key, f" must be {allowed}, not {given}")

    def _error(self, key: str, text: str) -> Exception:
        key = printable(key if len(key) <= MAX_SHOWN_CHARS else f"{key[:MAX_SHOWN_CHARS]}…")
        return self._error_class(f"{self._source}: {self._at(key) or 'the file'}{text}")

    def _at(self, key: str) -> str:
        return ".".join(part for part in (self._place, key) if part)


def excerpt(value: object) -> str:
    """Return a value for a message, at most `MAX_SHOWN_CHARS` long.

    >>> excerpt([1, "a"]), excerpt("b" * 99)[:10]
    ("[1, 'a']", "'bbbbbbbbb")
    """
    try:
        text = repr(value)
    except (ValueError, RecursionError):  # thousands of digits, or too deeply nested
        return "something so long"
    return text if len(text) <= MAX_SHOWN_CHARS else f"{text[:MAX_SHOWN_CHARS]}…"
