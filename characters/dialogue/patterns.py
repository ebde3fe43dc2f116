"""Patterns with `*` over the words of a text, matched in time that is linear in the text.

Case, accents and punctuation do not count: "¿Cómo estás?" is matched by `como estas`.
"""

import re
import unicodedata
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Self

from cubeling.characters.errors import CharacterError

MAX_HEARD_CHARS = 400
"""Characters of a text that are read: nobody types more in one line."""

MAX_SLOT_CHARS = 40
"""Longest word that is remembered."""

MAX_PATTERN_WORDS = 40
"""Longest pattern [words]."""

_WORD = re.compile(r"[^\s.,;:!?¡¿…()\"“”«»<>/\\|*_+=\[\]{}~`^&%$#@]+")
_ELEMENT = re.compile(r"\*|\{[^{}]*\}|[^\s*{}]+|[{}]")
_SLOT = re.compile(r"\{([a-z]\w*)\}")


def plain(word: str) -> str:
    """Return a word without case, accents and signs.

    >>> plain("Cómo"), plain("don't"), plain("❤")
    ('como', 'dont', '')
    """
    return "".join(c for c in unicodedata.normalize("NFKD", word.casefold()) if c.isalnum())


@dataclass(frozen=True)
class Heard:
    """A text as patterns see it."""

    text: str
    """As it was typed."""

    words: tuple[str, ...]
    """Its words, as they were typed."""

    plain: tuple[str, ...]
    """The same as `plain` writes them."""

    typed: bool = True
    """Whether a person said it, and it is no word of the cube."""

    @classmethod
    def of(cls, text: str, *, typed: bool = True) -> Self:
        """Return a text with its words; what has neither letters nor digits is no word."""
        found = [(word, plain(word)) for word in _WORD.findall(text[:MAX_HEARD_CHARS])]
        pairs = [pair for pair in found if pair[1]]
        return cls(text, tuple(p[0] for p in pairs), tuple(p[1] for p in pairs), typed)


@dataclass(frozen=True)
class Slot:
    """A place of a pattern whose word is remembered."""

    name: str
    """What it is remembered as."""


@dataclass(frozen=True)
class WordPattern:
    """A pattern of words: `*` stands for any number of them, `{slot}` for one to remember."""

    text: str
    """As it is written."""

    expression: "re.Pattern[str]" = field(compare=False)
    """Matches words, each with a space after it. Each part between two stars is looked for once,
    from left to right (atomic groups), so the time is linear in the text."""

    words: tuple[str, ...]
    """Its words, as `plain` writes them."""

    slots: tuple[str, ...]
    """Names of what it remembers."""

    parts: tuple[tuple[str | Slot, ...], ...]
    """What is before, between and after its stars."""

    @classmethod
    def read(cls, text: str) -> "WordPattern":
        """Return the pattern of a text.

        >>> WordPattern.read("* my name is {name} *").match(Heard.of("Well, my name is Bob!"))
        {'name': 'Bob'}
        >>> WordPattern.read("hello *").match(Heard.of("oh hello")) is None
        True

        Raises
        ------
        CharacterError
            It is empty or too long, or a slot is misspelt or there twice.
        """
        elements = _ELEMENT.findall(text)
        if not elements:
            raise CharacterError("an empty pattern; write words, or * for any")
        if len(elements) > MAX_PATTERN_WORDS:
            raise CharacterError(f"a pattern of more than {MAX_PATTERN_WORDS} words")
        parts: list[list[str | Slot]] = [[]]  # what is between the stars
        words, slots = list[str](), list[str]()
        for element in elements:
            slot = _SLOT.fullmatch(element)
            if element == "*":
                parts.append([])
            elif slot:
                if slot[1] in slots:
                    raise CharacterError(f"{element} twice in the pattern '{text.strip()}'")
                slots.append(slot[1])
                parts[-1].append(Slot(slot[1]))
            elif element[0] in "{}":
                raise CharacterError(f"'{element}' is no slot; write {{name}}")
            else:
                for each in Heard.of(element).plain:
                    words.append(each)
                    parts[-1].append(each)
        if len(parts) == 1 and not parts[0]:
            raise CharacterError(f"the pattern '{text.strip()}' has no word")
        expression = re.compile(_expression([[*map(_expression_of, part)] for part in parts]))
        return cls(text.strip(), expression, tuple(words), tuple(slots), tuple(map(tuple, parts)))

    @property
    def is_open(self) -> bool:
        """Whether any text matches it."""
        return not self.words and not self.slots

    def match(self, heard: Heard, spelled: tuple[str, ...] | None = None) -> dict[str, str] | None:
        """Return what it remembers of a text, or None if it does not match.

        `spelled` are its words in another spelling; what is remembered is as it was typed.
        """
        joined = "".join(f"{word} " for word in (heard.plain if spelled is None else spelled))
        found = self.expression.fullmatch(joined)
        if found is None:
            return None
        return {
            slot: heard.words[joined.count(" ", 0, found.start(slot))].strip("'’-")[:MAX_SLOT_CHARS]
            for slot in self.slots
        }


def _expression_of(element: str | Slot) -> str:
    return rf"(?P<{element.name}>\S+) " if isinstance(element, Slot) else re.escape(element) + " "


def _expression(parts: list[list[str]]) -> str:
    """Return the expression of parts that are between stars."""
    first, *rest = ("".join(part) for part in parts)
    if not rest:
        return first
    *middle, last = rest
    searched = "".join(rf"(?>.*?(?<!\S){part})" for part in middle if part)
    return first + searched + (rf".*(?<!\S){last}" if last else ".*")


def patterns_of(text: str) -> tuple[WordPattern, ...]:
    """Return the patterns of a text that `|` separates."""
    return tuple(map(WordPattern.read, text.split("|")))


def fill(text: str, profile: Mapping[str, str]) -> str:
    """Return a text with what is remembered in place of `{slot}` and `{slot|otherwise}`.

    A slot that begins with a capital letter gives a word that does.

    >>> fill("Hello, {Name|friend}! A {pet}?", {"name": "bob", "pet": "cat"})
    'Hello, Bob! A cat?'
    >>> fill("Hello, {Name|friend}!", {})
    'Hello, friend!'
    """

    def value(found: "re.Match[str]") -> str:
        known = profile.get(found[1].lower())
        if known is None:
            return found[2] or ""
        return known[:1].upper() + known[1:] if found[1][0].isupper() else known

    return FILLED.sub(value, text)


FILLED = re.compile(r"\{([A-Za-z]\w*)(?:\|([^{}]*))?\}")
"""A slot in a text that is said."""
