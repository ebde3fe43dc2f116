"""The behaviour `speech`: what a voice says, or an estimate of it until the voice has answered."""

import math
from itertools import pairwise

from characters.behaviour.bml import Behaviour, CannotPerform, Scheduled, Timing, rigid
from characters.behaviour.performing.performed import Performed, Performing, Saying
from characters.speech.speech import Utterance, Word

LETTER_S, WORD_S = 0.06, 0.06
"""Time of a letter, and what each word takes besides [s]: about 170 words a minute."""

PAUSE_S = {",": 0.2, ";": 0.3, ":": 0.3, ".": 0.5, "!": 0.5, "?": 0.5}
"""Pause after a word that ends so [s]."""

MAX_LETTERS = 5000
"""Longer texts are refused."""

XML = "http://www.w3.org/XML/1998/namespace"
"""Namespace of `xml:lang`."""


class SpeechKind:
    """Says a text; its sync points are at the words that follow its marks."""

    channel = ""

    def timing(self, behaviour: Behaviour, who: Performing) -> Timing:
        """Return the times of the voice, or those of an estimate."""
        if len(behaviour.text) > MAX_LETTERS:
            raise CannotPerform(f"a text of more than {MAX_LETTERS} letters; say it in parts")
        utterance = heard(behaviour, who) or estimated(behaviour.text)
        marks = [(mark.id, mark_time(utterance, mark.at)) for mark in behaviour.marks]
        names = ("start", *(name for name, _ in marks), "end")
        times = [0.0, *(time for _, time in marks), utterance.duration]
        spans = tuple(max(b - a, 0.0) for a, b in pairwise(times))
        return rigid(names, spans)

    def perform(self, scheduled: Scheduled, who: Performing, performed: Performed) -> None:
        """Say it, as soon as the voice has answered."""
        utterance, key = heard(scheduled.behaviour, who), scheduled.key
        if utterance is None:
            who.late[key] = math.inf
            return
        if who.late.get(key) == math.inf:
            who.late[key] = performed.now
        performed.sayings.append(Saying(key, utterance, who.late.get(key, scheduled.start)))


def heard(behaviour: Behaviour, who: Performing) -> Utterance | None:
    """Return what the voice says for a speech; None if it has not answered."""
    return who.utterance_of(behaviour.text, behaviour.get("lang", namespace=XML))


def estimated(text: str) -> Utterance:
    """Return an utterance with the words of a text at times that a voice might take.

    >>> estimated("No, never.").words
    (Word(text='No,', start=0.0, end=0.18, offset=0), Word(text='never.', start=0.38, end=0.74, offset=4))
    """  # noqa: E501
    words, at, offset = list[Word](), 0.0, 0
    for word in text.split():
        offset = text.index(word, offset)
        letters = sum(letter.isalnum() for letter in word)
        end = at + WORD_S + LETTER_S * letters
        words.append(Word(word, round(at, 6), round(end, 6), offset))
        at, offset = end + PAUSE_S.get(word[-1], 0.0), offset + len(word)
    return Utterance(text, "", max(at, 0.1), tuple(words))


def mark_time(utterance: Utterance, at: int) -> float:
    """Return when the next word after a mark begins [s]; the end after the last word."""
    return min((w.start for w in utterance.words if w.offset >= at), default=utterance.duration)
