"""The words that a script knows: what language a text is in, and what a misspelt word means."""

import difflib
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from functools import lru_cache
from typing import Self

MIN_LETTERS = 4
"""A shorter word is taken as it is."""

SHORT_LETTERS, SHORT_LIKENESS, LIKENESS = 5, 0.84, 0.74
"""How like another word a misspelt one is (`difflib`, 0…1): up to so many letters, and above."""


@dataclass(frozen=True)
class WordSet:
    """Words among which a misspelt one is found.

    Typing errors are rare in the first letter (Yannakoudakis and Fawthrop, 1983), so that words
    with another one need not be compared.
    """

    words: frozenset[str]
    """All of them, as `plain` writes them."""

    by_letter: Mapping[str, tuple[str, ...]]
    """Those that are long enough to be misspelt, by their first letter."""

    @classmethod
    def of(cls, words: Iterable[str]) -> Self:
        """Return the set of some words."""
        own = frozenset(words)
        letters: dict[str, list[str]] = {}
        for word in sorted(own):
            if len(word) >= MIN_LETTERS:
                letters.setdefault(word[0], []).append(word)
        return cls(own, {letter: tuple(found) for letter, found in letters.items()})

    def closest(self, word: str) -> str:
        """Return the word that another one means; "" for none.

        >>> words = WordSet.of(["hello", "what"])
        >>> words.closest("helo"), words.closest("want")
        ('hello', '')
        """
        if word in self.words:
            return word
        return "" if len(word) < MIN_LETTERS else _most_like(word, self.by_letter.get(word[0], ()))


@lru_cache(maxsize=2048)
def _most_like(word: str, words: tuple[str, ...]) -> str:
    least = SHORT_LIKENESS if len(word) <= SHORT_LETTERS else LIKENESS
    found = difflib.get_close_matches(word, words, 1, least)
    swapped = (each for each in words if sorted(each) == sorted(word))
    return found[0] if found else next(swapped, "")


@dataclass(frozen=True)
class Spelling:
    """The words of a script, by language."""

    matched: Mapping[str, WordSet]
    """Those of its patterns: misspelt words may mean them."""

    known: Mapping[str, frozenset[str]]
    """Those that it says, too: these are not misspelt."""

    def language_of(self, words: tuple[str, ...], present: str) -> str:
        """Return the language that knows most of the words; the present one if none knows more."""
        counts = {
            language: sum(word in known for word in words) for language, known in self.known.items()
        }
        return max(counts, key=lambda each: (counts[each], each == present), default=present)

    def correct(self, words: tuple[str, ...], language: str) -> tuple[str, ...]:
        """Return the words with those that are misspelt as the patterns have them."""
        known, matched = self.known.get(language, frozenset()), self.matched.get(language)
        if matched is None:
            return words
        return tuple(w if w in known else matched.closest(w) or w for w in words)
