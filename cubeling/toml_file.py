"""The one way to read TOML files: any room may, and one line says which key has which wrong value.

`TomlTable` gives validated values by key, or fills a dataclass by its types. JSON has no reader of
its own: messages between programs are msgspec structs, glTF has its own checker (`formats.gltf`).
"""

import dataclasses
import sys
import tomllib
import types
from collections.abc import Collection, Iterator, Mapping
from functools import cache
from pathlib import Path
from typing import Any, Literal, TypeVar, Union, get_args, get_origin, get_type_hints

from cubeling.files import FileKind

T = TypeVar("T")

MAX_FILE_BYTES = 65_536
"""Largest file [bytes]; a larger one was not written by hand."""

MAX_LONG_FILE_BYTES = 1_000_000
"""Largest file [bytes] of a kind that programs write too, or that grows with a character."""

MAX_LINE_CHARS = 2000
"""Longest line [characters]: `tomllib` takes half a minute for `a.a.a…` of 65 kB
(`test_a_file_made_to_keep_us_busy_is_refused_at_once`)."""

MAX_ENTRIES = 64
"""Most entries of a list, or of a table with free keys, unless the caller sets another limit."""

MAX_KEY_BYTES = 64
"""Longest free key [bytes of UTF-8], unless the caller sets a lower limit."""

MAX_SHOWN_CHARS = 60
"""Most characters of a wrong value or key in a message."""

LARGEST = sys.float_info.max
"""The greatest finite number: by default a number may not be infinite."""


def read(path: Path, kind: FileKind) -> dict[str, Any]:
    """Return the content of a TOML file.

    Raises
    ------
    kind.error
        If it cannot be opened, is too large (see `FileKind`), or is not TOML.
    """
    return parse(kind.read_text(path), printable(str(path)), kind.error)


def toml_kind(
    name: str, error: type[Exception], reader: str, max_bytes: int = MAX_FILE_BYTES
) -> FileKind:
    """Return a kind of TOML file; the arguments are the fields of `FileKind`."""
    return FileKind(name, (".toml",), error, max_bytes, reader)


def bundled(path: Path) -> dict[str, Any]:
    """Return the content of a TOML file that comes with the program."""
    return parse(path.read_text("utf-8"), path.name)


def parse(text: str, source: str, error: type[Exception] = ValueError) -> dict[str, Any]:
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
    most
        Most entries of a list, or of a table with free keys.
    """

    def __init__(
        self,
        values: Mapping[str, Any],
        source: str,
        place: str = "",
        error: type[Exception] = ValueError,
        most: int = MAX_ENTRIES,
    ) -> None:
        self._error_class = error
        self._values = values
        self.source = printable(source)
        """Name of the file."""
        self._most = most
        self.place = place
        """The keys of the table."""

    def __contains__(self, key: str) -> bool:
        return key in self._values

    def __iter__(self) -> Iterator[str]:
        return iter(self._values)

    def only(self, *keys: str) -> None:
        """Refuse all other keys."""
        for key in self._values:
            if key not in keys:
                near = _nearest(key, keys)
                hint = f"{near} There are" if near else "there are"
                raise self._error(key, f" means nothing here; {hint} {', '.join(keys)}")

    def names(self, longest: int = MAX_KEY_BYTES) -> list[str]:
        """Return the keys of a table with free keys, each at most `longest` bytes of UTF-8."""
        if len(self._values) > self._most:
            count = len(self._values)
            raise self.wrong("", f"must have at most {self._most} entries, not {count}")
        for key in self._values:
            if not key or not key.isprintable() or len(key.encode()) > longest:
                raise self.wrong(key, f"a name has 1 to {longest} bytes, all of them printable")
        return list(self._values)

    def value(self, key: str, default: object = None) -> Any:
        """Return a value of any kind."""
        return self._values.get(key, default)

    def table(self, key: str, *keys: str) -> "TomlTable":
        """Return a subtable, empty if missing; only `keys` are allowed in it, if any are given."""
        value = self._values.get(key, {})
        if not isinstance(value, Mapping):
            raise self.unlike(key, f"a table{' of ' if keys else ''}{', '.join(keys)}")
        return self._inner(value, self.at(key), keys)

    def tables(self, key: str, *keys: str, longest: int = MAX_KEY_BYTES) -> dict[str, "TomlTable"]:
        """Return the subtables of a subtable with free keys."""
        table = self.table(key)
        return {name: table.table(name, *keys) for name in table.names(longest)}

    def rows(self, key: str, *keys: str) -> tuple["TomlTable", ...]:
        """Return a list of tables, empty if missing, as `table` does."""
        rows = self.list(key, "tables")
        for row in rows:
            if not isinstance(row, Mapping):
                raise self.unlike(key, "tables", row)
        places = (f"{self.at(key)}[{number}]" for number in range(len(rows)))
        return tuple(self._inner(*row, keys) for row in zip(rows, places, strict=True))

    def text(self, key: str, default: str | None = None) -> str:
        """Return a text; refuse another type, and a missing one without a default."""
        value = self._values.get(key, default)
        if not isinstance(value, str):
            raise self.unlike(key, "a text")
        return value

    def line(self, key: str, default: str | None = None) -> str:
        """Return a text that can be printed in one line."""
        value = self.text(key, default)
        if not value.isprintable():
            raise self.unlike(key, "one line of text")
        return value

    def choice(self, key: str, choices: Collection[str], default: str | None = None) -> str:
        """Return one of some texts."""
        value = self._values.get(key, default)
        if not isinstance(value, str) or value not in choices:
            if near := _nearest(value, choices):
                raise self._error(key, f" is {excerpt(value)}, which is not known; {near}")
            known = ", ".join(filter(None, choices)) or "those that there are: none"
            raise self.unlike(key, f"one of {known}")
        return value

    def number(
        self, key: str, low: float = -LARGEST, high: float = LARGEST, default: float | None = None
    ) -> float:
        """Return a number from `low` to `high`; never NaN."""
        return self._number(key, self._values.get(key, default), low, high)

    def whole(
        self, key: str, low: int | None = None, high: int | None = None, default: int | None = None
    ) -> int:
        """Return a whole number from `low` to `high`."""
        value = self._values.get(key, default)
        least, most = -LARGEST if low is None else low, LARGEST if high is None else high
        if type(value) is not int or not least <= value <= most:
            raise self.unlike(key, f"a whole number{_range(least, most)}")
        return value

    def truth(self, key: str, default: bool | None = None) -> bool:
        """Return true or false."""
        value = self._values.get(key, default)
        if not isinstance(value, bool):
            raise self.unlike(key, "true or false")
        return value

    def list(self, key: str, of: str) -> list[Any]:
        """Return a list, empty if missing; `of` describes its entries in messages."""
        value = self._values.get(key, [])
        if not isinstance(value, list) or len(value) > self._most:
            raise self.unlike(key, f"a list of at most {self._most} {of}")
        return value

    def texts(self, key: str, default: tuple[str, ...] = ()) -> tuple[str, ...]:
        """Return a list of printable texts that are not empty."""
        if key not in self._values:
            return default
        for text in self.list(key, "texts"):
            if not isinstance(text, str) or not text.strip() or not text.isprintable():
                raise self.unlike(key, "texts that can be printed, none of them empty", text)
        return tuple(self._values[key])

    def numbers(
        self,
        key: str,
        count: int | None = None,
        low: float = -LARGEST,
        high: float = LARGEST,
        default: tuple[float, ...] | None = None,
    ) -> tuple[float, ...]:
        """Return a list of numbers from `low` to `high`, `count` of them unless it is None."""
        if key not in self._values and default is not None:
            return default
        value = self._values.get(key)
        if not isinstance(value, list) or len(value) != (len(value) if count is None else count):
            raise self.unlike(key, f"a list of {'' if count is None else f'{count} '}numbers")
        return tuple(self._number(key, each, low, high) for each in value)

    def fill(self, kind: type[T]) -> T:
        """Return a dataclass: a key for each field, of its type; what is left out is usual.

        A field may be a text, a number, a truth, a `Literal`, another dataclass, or a tuple. What
        the dataclass itself refuses by `error`, in `__post_init__`, is refused with its place.
        """
        hints, required = _fields(kind)  # type: ignore[arg-type] # classes are hashable
        self.only(*hints)
        values = {
            key: self._value_as(key, hint)
            for key, hint in hints.items()
            if key in self or key in required
        }
        try:
            return kind(**values)
        except self._error_class as error:
            place = f"{self.place}: " if self.place else ""
            raise self._error_class(f"{self.source}: {place}{error}") from None

    def wrong(self, key: str, why: str) -> Exception:
        """Return the error for a key of the file, with the reason."""
        return self._error(key, f": {why}")

    def unlike(self, key: str, allowed: str, value: object = None) -> Exception:
        """Return the error for a value that is not allowed; None for the value of the key."""
        if key not in self._values:
            return self._error(key, f" is missing; it must be {allowed}")
        value = self._values[key] if value is None else value
        return self._error(key, f" must be {allowed}, not {excerpt(value)}")

    def _value_as(self, key: str, hint: Any) -> Any:
        """Return the value of a key as a type says, one of those that `fill` knows."""
        args = get_args(hint)
        if get_origin(hint) in (Union, types.UnionType):  # None is a key that is left out
            return self._value_as(key, args[0])
        if get_origin(hint) is Literal:
            return self.choice(key, args)
        if dataclasses.is_dataclass(hint):
            return self.table(key).fill(hint)  # type: ignore[arg-type]
        if get_origin(hint) is not tuple:
            return self._scalar(key, self._values.get(key), hint)
        if dataclasses.is_dataclass(args[0]):
            return tuple(row.fill(args[0]) for row in self.rows(key))  # type: ignore[arg-type]
        listed = self.list(key, "entries")
        if args[-1] is not Ellipsis and len(listed) != len(args):
            raise self.unlike(key, f"a list of {len(args)}")
        return tuple(self._scalar(key, each, args[0]) for each in listed)

    def _scalar(self, key: str, value: object, kind: type[Any]) -> Any:
        if kind is float:
            return self._number(key, value, -LARGEST, LARGEST)
        if type(value) is not kind:
            raise self.unlike(key, _KINDS[kind], value)
        return value

    def _number(self, key: str, value: Any, low: float, high: float) -> float:
        if type(value) not in (int, float) or not low <= value <= high:  # refuses NaN and true
            raise self.unlike(key, f"a number{_range(low, high)}", value)
        return float(value)

    def _inner(self, values: Mapping[str, Any], place: str, keys: tuple[str, ...]) -> "TomlTable":
        table = TomlTable(values, self.source, place, self._error_class, self._most)
        if keys:
            table.only(*keys)
        return table

    def _error(self, key: str, text: str) -> Exception:
        return self._error_class(f"{self.source}: {self.at(key) or 'the file'}{text}")

    def at(self, key: str) -> str:
        """Return the keys of a value in the file, "moods.happy.posture", for messages."""
        key = printable(key if len(key) <= MAX_SHOWN_CHARS else f"{key[:MAX_SHOWN_CHARS]}…")
        return ".".join(part for part in (self.place, key) if part)


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


_KINDS = {str: "a text", int: "a whole number", bool: "true or false"}


def _range(low: float, high: float) -> str:
    """Return the words for a range; "" for all finite numbers."""
    if low <= -LARGEST:
        return "" if high >= LARGEST else f" up to {high:g}"
    return f" of at least {low:g}" if high >= LARGEST else f" from {low:g} to {high:g}"


def _nearest(value: object, choices: Collection[str]) -> str:
    """Return the question after the choice that a wrong value looks like; "" if there is none."""
    if not isinstance(value, str):
        return ""
    from difflib import get_close_matches  # only for a message: every start loads this module

    near = get_close_matches(value, choices, 1)
    return f"did you mean {near[0]!r}?" if near else ""


@cache
def _fields(kind: type[Any]) -> tuple[dict[str, Any], frozenset[str]]:
    """Return the types of a dataclass's fields, and the fields without a default."""
    hints = get_type_hints(kind)
    fields = [field for field in dataclasses.fields(kind) if field.init]
    missing = dataclasses.MISSING
    return {field.name: hints[field.name] for field in fields}, frozenset(
        field.name for field in fields if field.default is field.default_factory is missing
    )
