"""Asking a table of a settings file for its words, with errors that say where they are wrong."""

import re
from collections.abc import Callable, Mapping
from functools import partial
from typing import Any

from robot.drivers.opencat import tokens
from robot.errors import RobotError

Notes = tuple[tuple[int, int], ...]
"""Notes of a melody, each with its value: 4 is a quarter of a second, 8 an eighth."""


class Table:
    """A table of a settings file, whose words are asked for one by one and none is left over."""

    def __init__(self, content: Any, source: str, name: str) -> None:
        self._source, self._name = source, name
        if not isinstance(content, Mapping):
            raise self.wrong("this must be a table")
        self.left: dict[str, Any] = dict(content)
        """What has not been asked for yet."""

    def wrong(self, what: str) -> RobotError:
        """Return the error that says where the file is wrong."""
        place = f" [{self._name}]" if self._name else ""
        return RobotError(f"{self._source}{place}: {what}")

    def end(self) -> None:
        """Refuse whatever nobody asked for."""
        if self.left:
            raise self.wrong(f"the word {next(iter(self.left))!r} means nothing here")

    def table(self, key: str, default: Any = None) -> "Table":
        """Return a table in this one."""
        return Table(self._take(key, default), self._source, f"{self._name}.{key}".strip("."))

    def text(self, key: str, default: str | None = None) -> str:
        """Return a text."""
        value = self._take(key, default)
        if not isinstance(value, str):
            raise self.wrong(f"{key} must be a text, not {value!r}")
        return value

    def number(self, key: str, low: float, high: float, default: float | None = None) -> float:
        """Return a number from `low` to `high`."""
        value = self._take(key, default)
        if (
            isinstance(value, bool)
            or not isinstance(value, int | float)
            or not low <= value <= high
        ):
            raise self.wrong(f"{key} must be a number from {low:g} to {high:g}, not {value!r}")
        return float(value)

    def skill(self, key: str) -> str:
        """Return the name of a skill that may be sent."""
        name = self.text(key)
        self.may_send(lambda: tokens.skill(name))
        return name

    def skills(self, key: str) -> tuple[str, ...]:
        """Return the names of skills that may be sent; none if none is said."""
        names = self._take(key, [])
        if not isinstance(names, list) or not all(isinstance(name, str) for name in names):
            raise self.wrong(f"{key} must be a list of skills, not {names!r}")
        for name in names:
            self.may_send(partial(tokens.skill, name))
        return tuple(names)

    def melody(self, key: str) -> Notes:
        """Return a melody that may be sent."""
        notes = self._take(key, None)
        pairs = isinstance(notes, list) and all(
            isinstance(note, list) and len(note) == 2 and all(type(n) is int for n in note)
            for note in notes
        )
        if not pairs or not notes or not re.fullmatch(r"[\w -]{1,16}", key):
            raise self.wrong(f"{key!r} must be a list of [note, value] pairs, not {notes!r}")
        melody = tuple((note, value) for note, value in notes)
        self.may_send(lambda: tokens.melody(melody))
        return melody

    def may_send(self, make: Callable[[], bytes]) -> None:
        """Try to make a line for the board, and say where its refusal comes from."""
        try:
            make()
        except RobotError as error:
            raise self.wrong(str(error)) from error

    def _take(self, key: str, default: Any) -> Any:
        value = self.left.pop(key, default)
        if value is None:
            raise self.wrong(f"{key!r} is missing")
        return value
