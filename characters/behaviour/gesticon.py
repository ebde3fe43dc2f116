"""One gesticon: what a name leads to, whoever wrote it.

A name leads to a symbolic gesture, a movement of the head, something on the face, a posture, or a
clip of the character with a joint mask of its own (Egges 2006, section 5.3). `gesticon.toml` holds
the other names of each:

    [head]
    SHAKE = ["shake head", "head shake", "no"]

A name is taken apart into words: at "_", "-", spaces, digits and capitals, so that "shake_head",
"ShakeHead" and "shake head" are one.
"""

import re
from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from types import MappingProxyType
from typing import Literal, get_args

from cubeling.characters.errors import CharacterError
from cubeling.toml_file import MAX_LONG_FILE_BYTES, TomlTable, read, toml_kind

GESTICON_FILE = toml_kind(
    "gesticon",
    CharacterError,
    "cubeling.characters.behaviour.gesticon:Gesticon.load",
    MAX_LONG_FILE_BYTES,
)
"""A file of the other names of gestures, movements, faces, postures and clips."""

MeaningKind = Literal["gesture", "head", "face", "posture", "clip"]
"""What a name leads to."""

CLIP_PARTS = ("head", "arms")
"""Parts of the body that clips may be for."""

NO_CLIPS: Mapping[str, Collection[str]] = MappingProxyType({})
"""No clips: all are for what they move."""

MAX_WORDS = 12
"""Words of a name that are looked at."""

_WORD = re.compile(r"[A-Z]?[a-z]+|[A-Z]+(?![a-z])")


@dataclass(frozen=True)
class Meaning:
    """What a name leads to."""

    kind: MeaningKind

    name: str
    """Of a gesture, a movement of the head, something on a face, a posture, or a clip."""


class Gesticon:
    """Finds what names lead to.

    Parameters
    ----------
    aliases
        By meaning, its names in words; those that come first go first.
    clips
        By part of the body, "head" or "arms", the clips that are for it.
    """

    def __init__(
        self,
        aliases: Mapping[Meaning, Collection[str]],
        clips: Mapping[str, Collection[str]] = NO_CLIPS,
    ) -> None:
        self._parts = {words_of(name): part for part, names in clips.items() for name in names}
        self._exact: dict[tuple[str, ...], Meaning] = {}
        self._by_word: dict[str, list[tuple[frozenset[str], Meaning]]] = {}
        for meaning, names in aliases.items():
            for name in names:
                words = words_of(name)
                if not words or words in self._exact:
                    continue
                self._exact[words] = meaning
                self._by_word.setdefault(words[0], []).append((frozenset(words), meaning))

    @staticmethod
    def load(path: Path | None = None) -> "Gesticon":
        """Read a gesticon, the bundled one if no file is named.

        Raises
        ------
        CharacterError
            If it cannot be read, or is no gesticon.
        """
        path = Path(__file__).with_name("gesticon.toml") if path is None else path
        file = TomlTable(read(path, GESTICON_FILE), str(path), error=CharacterError)
        file.only(*get_args(MeaningKind))
        aliases: dict[Meaning, Collection[str]] = {}
        tables = {kind: file.table(kind) for kind in get_args(MeaningKind) if kind in file}
        clips = tables.pop("clip", None)
        for kind, names in tables.items():
            for name in names:
                aliases[Meaning(kind, name)] = (name, *names.texts(name))
        if clips is None:
            return Gesticon(aliases)
        clips.only(*CLIP_PARTS)
        return Gesticon(aliases, {part: clips.texts(part) for part in clips})

    @staticmethod
    @cache
    def bundled() -> "Gesticon":
        """Return the one that comes with the program."""
        return Gesticon.load()

    @property
    def names(self) -> tuple[str, ...]:
        """What names lead to, each once."""
        return tuple(dict.fromkeys(meaning.name for meaning in self._exact.values()))

    def meaning(self, name: str) -> Meaning | None:
        """Return what a name leads to; None if it has no such name.

        >>> Gesticon.bundled().meaning("raise_shoulders")
        Meaning(kind='gesture', name='SHRUG')
        """
        return self._exact.get(words_of(name))

    def clip_part(self, name: str) -> str:
        """Return the part of the body that a clip is for, "head" or "arms"; "" if it is not told.

        >>> Gesticon.bundled().clip_part("nod"), Gesticon.bundled().clip_part("wave")
        ('head', '')
        """
        return self._parts.get(words_of(name), "")

    def nearest(self, name: str, kinds: Collection[str] = get_args(MeaningKind)) -> Meaning | None:
        """Return what the words of a name lead to: most of them, and then the first.

        >>> Gesticon.bundled().nearest("ChrBrad@Idle01_BeatMidBt01").name
        'BEAT_BOTH'
        """
        return next(self.within(name, kinds), None)

    def within(self, name: str, kinds: Collection[str]) -> Iterator[Meaning]:
        """Yield all that words of a name lead to, no word twice; what has most words first.

        >>> [each.name for each in Gesticon.bundled().within("Down_Aside_Right", ["head"])]
        ['DOWN', 'RIGHT']
        """
        words = words_of(name)
        found = [
            (-len(alias), words.index(word), order, alias, meaning)
            for word in dict.fromkeys(words)
            for order, (alias, meaning) in enumerate(self._by_word.get(word, ()))
            if meaning.kind in kinds and alias <= set(words)
        ]
        used: set[str] = set()
        for *_, alias, meaning in sorted(found, key=lambda each: each[:3]):
            if not alias & used:
                used |= alias
                yield meaning


def words_of(name: str) -> tuple[str, ...]:
    """Return the words of a name in lower case, without digits.

    >>> words_of("LHandOnHip_Arms-GestureWhy01")
    ('l', 'hand', 'on', 'hip', 'arms', 'gesture', 'why')
    """
    return tuple(word.lower() for word in _WORD.findall(name)[:MAX_WORDS])
