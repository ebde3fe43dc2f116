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

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from cubeling.characters.behaviour.bml.document import SYNC_NAMES, SYNCS
from cubeling.characters.behaviour.bml.parser import SECONDS
from cubeling.characters.errors import CharacterError
from cubeling.toml_file import MAX_LONG_FILE_BYTES, TomlTable, read, toml_kind

LEXICON_FILE = toml_kind(
    "lexicon",
    CharacterError,
    "cubeling.characters.behaviour.fml.lexicon:Lexicon.load",
    MAX_LONG_FILE_BYTES,
)
"""A file of behaviours by intention."""

MAX_ENTRIES = 1000
"""Most types of a kind of intention."""


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
        path = Path(__file__).with_name("lexicon.toml") if path is None else path
        return Lexicon.of(read(path, LEXICON_FILE), str(path))

    @staticmethod
    def of(document: Mapping[str, Any], source: str = "lexicon.toml") -> "Lexicon":
        """Return what the document of a lexicon says; `source` names it in messages.

        Raises
        ------
        CharacterError
            If it is no lexicon.
        """
        file = TomlTable(document, source, error=CharacterError, most=MAX_ENTRIES)
        return Lexicon(
            {
                (kind, name): tuple(_shown(row) for row in types.rows(name))
                for kind, types in ((kind, file.table(kind)) for kind in file)
                for name in types
            }
        )


def _shown(table: TomlTable) -> Shown:
    behaviour = table.choice("behaviour", SYNCS)
    named = [key for key in table if key not in ("behaviour", "scaled", "least")]
    points = [key for key in named if key in SYNC_NAMES]
    for key in points:
        if key not in SYNCS[behaviour]:
            raise table.wrong(key, f"a {behaviour} has no such sync point")
    attributes = {key: table.value(key) for key in named if key not in points}
    for key, value in attributes.items():
        if not isinstance(value, str):
            table.number(key)
    scaled = table.texts("scaled")
    if any(isinstance(attributes.get(key, ""), str) for key in scaled):
        raise table.unlike("scaled", "names of attributes that are numbers")
    least = table.number("least", 0.0, 1.0, 0.0)
    syncs = {key: _moment(table, key) for key in points}
    return Shown(behaviour, syncs, attributes, frozenset(scaled), least)


def _moment(table: TomlTable, key: str) -> tuple[str, float]:
    text = table.text(key)
    for end in ("start", "end"):
        offset = text.removeprefix(end)
        if text == end:
            return end, 0.0
        if offset != text and offset[0] in "+-" and SECONDS.fullmatch(offset):
            return end, float(offset)
    raise table.unlike(key, "start, end, or seconds after one of them, start+0.5")
