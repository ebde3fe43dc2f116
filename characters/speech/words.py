"""The words of a text, and their times in a speech."""

import re
from dataclasses import replace

import numpy as np

from cubeling.characters.speech.speech import SILENCE, Phone, Speech, Word

_WORD = re.compile(r"[^\W_]+(?:['’][^\W_]+)*")


def written_words(text: str) -> list[tuple[str, int]]:
    """Return each word of a text and the index of its first character.

    >>> written_words("Don't stop. 😀")
    [("Don't", 0), ('stop', 6)]
    """
    return [(match.group(), match.start()) for match in _WORD.finditer(text)]


def with_every_word(speech: Speech) -> Speech:
    """Return a speech that has every word of its text.

    A voice may speak words as one, such as eSpeak NG "to be", or name a blank. The phones of such
    words are shared out by the number of their letters.
    """
    words: list[Word] = []
    known = list(speech.words)
    written = written_words(speech.text)
    for index, word in enumerate(known):
        after = known[index + 1].offset if index + 1 < len(known) else len(speech.text)
        own_end = word.offset + len(word.text)
        merged = [each for each in written if own_end <= each[1] and _ends(each) <= after]
        words += _share(word, merged, speech.phones)
    return replace(speech, words=tuple(words))


def _ends(word: tuple[str, int]) -> int:
    return word[1] + len(word[0])


def _share(word: Word, merged: list[tuple[str, int]], phones: tuple[Phone, ...]) -> list[Word]:
    """Return a word and those that are spoken with it, with the times of their phones."""
    inside = [p for p in phones if p.symbol != SILENCE and word.start <= p.start < word.end]
    named = [(word.text, word.offset)] if written_words(word.text) else []
    parts = [*named, *merged]
    if len(parts) < 2 or len(inside) < len(parts):
        return [replace(word, text=text, offset=offset) for text, offset in parts[:1]]
    letters = np.cumsum([len(text) for text, _ in parts]) / sum(len(text) for text, _ in parts)
    cuts = [0, *np.rint(letters * len(inside)).astype(int).tolist()]
    for number in range(1, len(cuts) - 1):  # each has a phone at least
        most = len(inside) - (len(parts) - number)
        cuts[number] = min(max(cuts[number], cuts[number - 1] + 1), most)
    return [
        Word(text, inside[first].start, inside[last - 1].end, offset)
        for (text, offset), first, last in zip(parts, cuts, cuts[1:], strict=False)
    ]
