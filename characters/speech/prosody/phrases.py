"""Phrases of a speech: what is said in one go, and where a new topic begins."""

import re
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise

from cubeling.characters.speech.speech import SILENCE, Phone, Utterance, Word

MIN_PAUSE_S = 0.25
"""A shorter pause ends no phrase by itself [s]."""

_BREAK = re.compile(r"[.,;:!?…—–()«»]|\n\s*\n")
_SENTENCE_END = re.compile(r"[.!?…][^\w]*$|\n\s*\n\s*$")
_TOPIC_END = re.compile(r"\n[^\S\n]*\n")


@dataclass(frozen=True)
class Phrase:
    """What is said in one go: up to a punctuation mark or a pause."""

    start: float
    """When its first word begins, from the start of the speech [s]."""

    end: float
    """When its last word ends [s]."""

    text: str = ""
    """The part of the text up to the next phrase; "" if it is not known."""

    opens_topic: bool = False
    """Whether an empty line stands before it in the text (`<topic/>` of a tagged one)."""

    @property
    def ends_sentence(self) -> bool:
        """Whether a sentence ends with it."""
        return _SENTENCE_END.search(self.text) is not None


def phrases_of(utterance: Utterance) -> tuple[Phrase, ...]:
    r"""Return the phrases of a speech, in order; without words, what is between its pauses.

    >>> words = (Word("Stop", 0.0, 0.4, 0), Word("you", 0.5, 0.7, 6), Word("So", 1.0, 1.2, 13))
    >>> [each.text for each in phrases_of(Utterance("Stop, you.\n\n So", "en", 1.2, words))]
    ['Stop, ', 'you.\n\n ', 'So']
    """
    if utterance.words:
        return tuple(_by_words(utterance.text, utterance.words))
    return tuple(_by_pauses(utterance.phones))


def _by_words(text: str, words: tuple[Word, ...]) -> Iterator[Phrase]:
    first, opens = words[0], False
    for word, after in pairwise((*words, None)):
        assert word is not None
        between = text[word.offset + len(word.text) : after.offset] if after else ""
        paused = after is not None and after.start - word.end >= MIN_PAUSE_S
        if after is None or paused or _BREAK.search(between):
            said = text[first.offset : after.offset if after else len(text)]
            yield Phrase(first.start, word.end, said, opens)
            if after is not None:
                first, opens = after, _TOPIC_END.search(between) is not None


def _by_pauses(phones: tuple[Phone, ...]) -> Iterator[Phrase]:
    start = end = None
    for phone in phones:
        if phone.symbol != SILENCE:
            start, end = phone.start if start is None else start, phone.end
        elif start is not None and end is not None and phone.end - phone.start >= MIN_PAUSE_S:
            yield Phrase(start, end)
            start = None
    if start is not None and end is not None:
        yield Phrase(start, end)
