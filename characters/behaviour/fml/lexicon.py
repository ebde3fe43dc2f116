"""What shows an intention or an emotion: a lexicon of behaviours, a TOML file.

    [[performative.greet]]
    behaviour = "gesture"
    lexeme = "WAVE"
    start = "start"

    [[emphasis.strong]]
    behaviour = "head"
    lexeme = "NOD"
    amount = 0.6
    scaled = ["amount"]
    stroke = "start+0.1"

Every table is one behaviour of what its name says, "kind.type". A sync point of it is at the start
or the end of the intention, or some seconds from that. The attributes in `scaled` are multiplied
by how important or intense the intention is. "{target}" stands for what it is about; a behaviour
with it is left out if that is not said.
"""

import tomllib
from collections.abc import Mapping
from dataclasses import dataclass, field
from importlib.resources import files
from pathlib import Path
from typing import Any

from cubeling.characters.behaviour.bml.document import SYNC_NAMES, SYNCS
from cubeling.characters.behaviour.bml.parser import SECONDS
from cubeling.characters.errors import CharacterError
from cubeling.characters.model.files import read_text

MAX_BYTES = 1_000_000
"""Larger files are no lexicons."""


@dataclass(frozen=True)
class Shown:
    """A behaviour that shows an intention."""

    behaviour: str
    """Its kind: the name of a BML element."""

    syncs: Mapping[str, tuple[str, float]] = field(default_factory=dict)
    """Sync points of it: "start" or "end" of the intention, and seconds after that."""

    attributes: Mapping[str, str | float] = field(default_factory=dict)
    """Its attributes; numbers may be scaled."""

    scaled: frozenset[str] = frozenset()
    """Attributes that are multiplied by importance or intensity."""

    least: float = 0.0
    """Least importance or intensity for which it is shown, 0…1."""


class Lexicon:
    """Behaviours by kind and type of intention."""

    def __init__(self, entries: Mapping[tuple[str, str], tuple[Shown, ...]]) -> None:
        self.entries = entries
        """Behaviours by kind and type: ("emotion", "joy")."""

    def __contains__(self, intention: tuple[str, str]) -> bool:
        return intention in self.entries

    @staticmethod
    def load(path: Path | None = None) -> "Lexicon":
        """Read a lexicon, the bundled one if no file is named.

        Raises
        ------
        CharacterError
            If it cannot be read, or is no lexicon.
        """
        if path is None:
            return Lexicon.parse((files(__package__) / "lexicon.toml").read_text("utf-8"))
        return Lexicon.parse(read_text(path, MAX_BYTES), str(path))

    @staticmethod
    def parse(text: str, origin: str = "lexicon.toml") -> "Lexicon":
        """Return what the text of a lexicon says.

        Raises
        ------
        CharacterError
            If it is no lexicon.
        """
        try:
            document = tomllib.loads(text)
        except (tomllib.TOMLDecodeError, RecursionError) as error:
            raise CharacterError(f"{origin}: {error}") from None
        entries = {}
        for kind, types in document.items():
            if not isinstance(types, dict):
                raise CharacterError(f"{origin}: {kind} is no table; write [[{kind}.TYPE]]")
            for name, tables in types.items():
                where = f"{origin}: {kind}.{name}"
                if not isinstance(tables, list) or not all(isinstance(t, dict) for t in tables):
                    raise CharacterError(f"{where} is no list of tables; write [[{kind}.{name}]]")
                entries[kind, name] = tuple(_read_shown(table, where) for table in tables)
        return Lexicon(entries)


def _read_shown(table: dict[str, Any], where: str) -> Shown:
    given = dict(table)
    behaviour = given.pop("behaviour", None)
    if behaviour not in SYNCS:
        raise CharacterError(
            f"{where}: behaviour is {behaviour!r}; choose one of {', '.join(SYNCS)}"
        )
    scaled, least = given.pop("scaled", []), given.pop("least", 0.0)
    syncs = {key: _moment(given.pop(key), where) for key in [*given] if key in SYNC_NAMES}
    unknown = [key for key in syncs if key not in SYNCS[behaviour]]
    if unknown:
        raise CharacterError(f"{where}: a {behaviour} has no sync point {unknown[0]}")
    for key, value in given.items():
        if isinstance(value, bool) or not isinstance(value, str | int | float):
            raise CharacterError(f"{where}: {key} is {value!r}; give a text or a number")
    if not isinstance(scaled, list) or any(not _is_number(given.get(key)) for key in scaled):
        raise CharacterError(f"{where}: scaled is {scaled!r}; name attributes that are numbers")
    if not _is_number(least) or not 0.0 <= least <= 1.0:
        raise CharacterError(f"{where}: least is {least!r}; give 0 to 1")
    return Shown(behaviour, syncs, given, frozenset(scaled), least)


def _moment(text: object, where: str) -> tuple[str, float]:
    for end in ("start", "end"):
        if isinstance(text, str) and text.startswith(end):
            offset = text[len(end) :]
            if not offset:
                return end, 0.0
            if offset[0] in "+-" and SECONDS.fullmatch(offset):
                return end, float(offset)
    raise CharacterError(f"{where}: {text!r} is no moment; write start, end or start+0.5")


def _is_number(value: object) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool)
