"""The words that a script knows: what language a text is in, and what a misspelt word means."""

import difflib
import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from functools import cached_property, lru_cache
from typing import Self

MIN_LETTERS = 4
"""A shorter word is taken as it is."""

SHORT_LETTERS, SHORT_LIKENESS, LIKENESS = 5, 0.84, 0.74
"""How like another word a misspelt one is (`difflib`, 0…1): up to so many letters, and above."""

SOUND_ALIKE: Mapping[str, tuple[tuple[str, str], ...]] = {
    "en": (
        (r"ph", "f"), (r"wh", "w"), (r"ck|c(?=[aou])", "k"), (r"^kn", "n"), (r"ou", "o"),
        (r"(.)\1", r"\1"), (r"(?<=[^aeiou])e$", ""),
    ),
    "es": (
        (r"ch", "ç"), (r"qu(?=[ei])|c(?=[^eiç]|$)", "k"), (r"c|z", "s"), (r"g(?=[ei])", "j"),
        (r"gu(?=[ei])", "g"), (r"h", ""), (r"ll", "y"), (r"v", "b"),
    ),
}  # fmt: skip
"""Letters of a language that sound alike, as patterns with what is written instead, in turn:
children write as they hear."""


def sound_of(word: str, language: str) -> str:
    """Return a word in letters that differ where it sounds different.

    >>> sound_of("yamo", "es") == sound_of("llamo", "es"), sound_of("wat", "en")
    (True, 'wat')
    """
    for letters, sound in SOUND_ALIKE.get(language, ()):
        word = re.sub(letters, sound, word)
    return word


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

    @cached_property
    def _by_sound(self) -> Mapping[str, Mapping[str, str]]:
        """The shortest word of the patterns for each of their sounds, by language."""
        return {
            language: {
                sound_of(word, language): word
                for word in sorted(matched.words, key=lambda each: (-len(each), each))
            }
            for language, matched in self.matched.items()
        }

    def correct(self, words: tuple[str, ...], language: str) -> tuple[str, ...]:
        """Return the words with those that are misspelt as the patterns have them."""
        known, matched = self.known.get(language, frozenset()), self.matched.get(language)
        if matched is None:
            return words
        by_sound = self._by_sound[language]
        return tuple(
            w if w in known else by_sound.get(sound_of(w, language)) or matched.closest(w) or w
            for w in words
        )
