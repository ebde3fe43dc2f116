"""What a person has written in a TOML file, asked for by its kind.

Personalities and the settings of robots are read with it. What cannot be is refused in one line:
"FILE: KEY must be WHAT IS ALLOWED, not WHAT WAS SAID", raised as the error of the room that asks.
"""

import math
import stat
import tomllib
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from affect.errors import AffectError

LARGEST = 65_536
"""Most bytes of a file; more was not written by hand."""

LINE_MAX = 2000
"""Longest line of one [characters]: `a.a.a…` on one of 65 kB keeps `tomllib` busy for half a minute
(`test_a_file_made_to_keep_us_busy_is_refused_at_once`)."""

ENTRIES_MAX = 64
"""Most entries of a list, or of a table whose keys a person makes up."""

KEY_MAX = 64
"""Longest such key [bytes of UTF-8], where nothing asks for a shorter one."""

SHOWN_MAX = 60
"""Of a wrong value, or a wrong key, so many characters are shown."""


def read(path: Path, error: type[Exception] = AffectError) -> dict[str, Any]:
    """Return what a TOML file says.

    Raises
    ------
    error
        If it cannot be read, is no file (a device or a pipe may never end), or is not TOML.
    """
    source = printable(str(path))
    try:
        if not stat.S_ISREG(path.stat().st_mode):
            raise error(f"cannot read {source}: it is no file")
        with path.open("rb") as file:
            data = file.read(LARGEST + 1)
    except (OSError, ValueError) as cause:  # ValueError: a name that no file can have
        reason = getattr(cause, "strerror", None) or cause
        raise error(f"cannot read {source}: {reason}") from None
    if len(data) > LARGEST:
        raise error(f"{source}: larger than {LARGEST} bytes; nobody wrote that by hand")
    try:
        return parsed(data.decode("utf-8-sig"), source, error)
    except UnicodeDecodeError as cause:
        raise error(f"{source}: not UTF-8 (byte {cause.start}); save it as that") from None


def parsed(text: str, source: str, error: type[Exception] = AffectError) -> dict[str, Any]:
    """Return what a TOML text says; `source` names it in the error if it is none."""
    if max(map(len, text.split("\n"))) > LINE_MAX:
        raise error(f"{source}: a line has more than {LINE_MAX} characters; break it")
    try:
        return tomllib.loads(text)
    except RecursionError:
        raise error(f"{source}: not TOML that can be read: too deeply nested") from None
    except ValueError as cause:  # no TOML, or a number with thousands of digits
        raise error(f"{source}: not TOML: {printable(str(cause))}") from None


def printable(text: str) -> str:
    """Return a text as it can stand in a line."""
    return text if text.isprintable() else repr(text)


class Table:
    """A table of a file, which is asked for its values by what they should be.

    Every method raises `error` where the value is another, or is missing and has no default.

    Parameters
    ----------
    values
        What it says.
    source
        Name of the file, for messages.
    place
        The keys that lead to it, "moods.happy"; empty for the whole file.
    error
        What is raised.
    """

    def __init__(
        self,
        values: Mapping[str, Any],
        source: str,
        place: str = "",
        error: type[Exception] = AffectError,
    ) -> None:
        self._raised = error
        self._values = values
        self._source = printable(source)
        self._place = place

    def __contains__(self, key: str) -> bool:
        return key in self._values

    # --- Its keys ------------------------------------------------------------------------------

    def only(self, *keys: str) -> None:
        """Refuse every other key."""
        for key in self._values:
            if key not in keys:
                raise self._error(key, f" means nothing here; there are {', '.join(keys)}")

    def names(self, longest: int = KEY_MAX) -> list[str]:
        """Return its keys where a person makes them up, each up to `longest` bytes of UTF-8."""
        if len(self._values) > ENTRIES_MAX:
            raise self.wrong(
                "", f"must have at most {ENTRIES_MAX} entries, not {len(self._values)}"
            )
        for key in self._values:
            if not key or not key.isprintable() or len(key.encode()) > longest:
                raise self.wrong(key, f"a name has 1 to {longest} bytes, all of them printable")
        return list(self._values)

    # --- Its values ----------------------------------------------------------------------------

    def table(self, key: str, *keys: str) -> "Table":
        """Return a table in it, empty if there is none; with no other than `keys`, if any."""
        value = self._values.get(key, {})
        if not isinstance(value, Mapping):
            raise self.unlike(key, f"a table{' of ' if keys else ''}{', '.join(keys)}")
        table = Table(value, self._source, self._at(key), self._raised)
        if keys:
            table.only(*keys)
        return table

    def tables(self, key: str, *keys: str, longest: int = KEY_MAX) -> dict[str, "Table"]:
        """Return the tables in a table by the names that a person gave them."""
        table = self.table(key)
        return {name: table.table(name, *keys) for name in table.names(longest)}

    def text(self, key: str, default: str | None = None) -> str:
        """Return a text."""
        value = self._values.get(key, default)
        if not isinstance(value, str):
            raise self.unlike(key, "a text")
        return value

    def number(
        self,
        key: str,
        low: float = -math.inf,
        high: float = math.inf,
        default: float | None = None,
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
        """Return a list of whatever, empty if there is none; `of` says what it should be of."""
        value = self._values.get(key, [])
        if not isinstance(value, list) or len(value) > ENTRIES_MAX:
            raise self.unlike(key, f"a list of at most {ENTRIES_MAX} {of}")
        return value

    def texts(self, key: str, default: tuple[str, ...] = ()) -> tuple[str, ...]:
        """Return a list of texts that can be printed, none of them empty."""
        if key not in self._values:
            return default
        for text in self.list(key, "texts"):
            if not isinstance(text, str) or not text.strip() or not text.isprintable():
                raise self.unlike(key, "texts that can be printed, none of them empty", text)
        return tuple(self._values[key])

    # --- What is wrong with it -----------------------------------------------------------------

    def wrong(self, key: str, why: str) -> Exception:
        """Return the error that says where the file is wrong, and why."""
        return self._error(key, f": {why}")

    def unlike(self, key: str, allowed: str, value: object = None) -> Exception:
        """Return the error for a value that is not what is allowed; None for the key's own."""
        if key not in self._values:
            return self._error(key, f" is missing; it must be {allowed}")
        said = shown(self._values[key] if value is None else value)
        return self._error(key, f" must be {allowed}, not {said}")

    def _error(self, key: str, what: str) -> Exception:
        key = printable(key if len(key) <= SHOWN_MAX else f"{key[:SHOWN_MAX]}…")
        return self._raised(f"{self._source}: {self._at(key) or 'the file'}{what}")

    def _at(self, key: str) -> str:
        return ".".join(part for part in (self._place, key) if part)


def shown(value: object) -> str:
    """Return a value as a person is told it; whatever it is, it does not fill the line.

    >>> shown([1, "a"]), shown("b" * 99)[:10]
    ("[1, 'a']", "'bbbbbbbbb")
    """
    try:
        text = repr(value)
    except (ValueError, RecursionError):  # a number of thousands of digits; tables in tables
        return "something so long"
    return text if len(text) <= SHOWN_MAX else f"{text[:SHOWN_MAX]}…"
