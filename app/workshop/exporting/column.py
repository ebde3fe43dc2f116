"""A column of an export, and a table of columns."""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from typing import Any

from cubeling.app.session import SessionFile

Cell = Any
"""A number, text, truth value or None, or in a nested column a list of them."""


@dataclass(frozen=True)
class Column:
    """One column of a table."""

    name: str
    """Its name in the files."""

    unit: str
    """Its unit; "" where it has none."""

    meaning: str
    """What it holds, for the data dictionary."""

    value: Callable[[Any], Cell]
    """Takes it from a message of the table's topic."""

    nested: bool = False
    """Whether it is a list, which only JSON Lines can hold."""


@dataclass(frozen=True)
class Table:
    """One table: a row for every message of a topic."""

    name: str
    """Name of its files, without a suffix."""

    topic: str
    """Topic of the messages in a session."""

    columns: tuple[Column, ...]
    """Its own columns, after those of `CONTEXT_COLUMNS`."""

    read: Callable[[SessionFile], Iterable[tuple[float, Any]]] | None = None
    """Returns times [s] and rows where a row is not a message of the topic; None where it is."""


def field(name: str, unit: str, meaning: str, path: str = "", nested: bool = False) -> Column:
    """Return a column for a field of the message, "emotion.valence" for one of a field's fields."""
    parts = (path or name).split(".")

    def value(message: Any) -> Cell:
        for part in parts:
            message = None if message is None else getattr(message, part)
        return message

    return Column(name, unit, meaning, value, nested)


def vector(
    names: Sequence[str], unit: str, meanings: Sequence[str], value: Callable[[Any], Any]
) -> tuple[Column, ...]:
    """Return a column for each number of a vector; all are empty where it is None."""

    def element(index: int) -> Callable[[Any], Cell]:
        def pick(message: Any) -> Cell:
            numbers = value(message)
            return None if numbers is None else float(numbers[index])

        return pick

    return tuple(
        Column(name, unit, meaning, element(index))
        for index, (name, meaning) in enumerate(zip(names, meanings, strict=True))
    )
