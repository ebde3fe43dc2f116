"""The behaviour `speech`: what a voice says, or an estimate of it until the voice has answered."""

import math
from bisect import bisect_left
from collections.abc import Iterator
from itertools import pairwise

from cubeling.characters.behaviour.bml import (
    Behaviour,
    CannotRealize,
    Realizer,
    Scheduled,
    Timing,
    rigid,
)
from cubeling.characters.behaviour.realization.frame import (
    RealizationContext,
    RealizedFrame,
    Saying,
)
from cubeling.characters.speech.speech import Utterance, Word

LETTER_S, WORD_S = 0.06, 0.06
"""Time of a letter, and what each word takes besides [s]: about 170 words a minute."""

PAUSE_S = {",": 0.15, ";": 0.25, ":": 0.25, ".": 0.35, "!": 0.35, "?": 0.35}
"""Pause after a word that ends so [s], unless it is the last one."""

SHORTEST_S = 0.1
"""Time of a speech without words [s]."""

MAX_LETTERS = 5000
"""Longer texts are refused."""

XML = "http://www.w3.org/XML/1998/namespace"
"""Namespace of the attribute `xml:lang`."""


class SpeechKind:
    """Says a text; its sync points are at the words that follow its marks."""

    channel = ""

    def timing(self, behaviour: Behaviour, who: RealizationContext) -> Timing:
        """Return the times of the voice, or those of an estimate."""
        if len(behaviour.text) > MAX_LETTERS:
            raise CannotRealize(f"a text of more than {MAX_LETTERS} letters; say it in parts")
        utterance = utterance_of(behaviour, who)
        if utterance is None:
            who.estimated.add(_text_and_language(behaviour))
            utterance = estimate(behaviour.text)
        marks = [*_times_of_marks(behaviour, utterance)]
        names = ("start", *(name for name, _ in marks), "end")
        times = [0.0, *(time for _, time in marks), utterance.duration]
        spans = tuple(max(b - a, 0.0) for a, b in pairwise(times))
        return rigid(names, spans)

    def realize(self, scheduled: Scheduled, who: RealizationContext, frame: RealizedFrame) -> None:
        """Say it, as soon as the voice has answered."""
        utterance, key = utterance_of(scheduled.behaviour, who), scheduled.key
        if utterance is None:
            who.late[key] = math.inf
        start = who.late.get(key, scheduled.start)
        if utterance is not None and start < math.inf:
            frame.sayings.append(Saying(key, utterance, start))


def retime_speeches(realizer: Realizer, who: RealizationContext, now: float) -> None:
    """Move the sync points of speeches that were estimated to where the voice has them.

    A speech that had begun without its voice sounds from now on.
    """
    if not who.estimated:
        return
    known: set[tuple[str, str]] = set()
    waiting: set[tuple[str, str]] = set()
    moves: list[tuple[str, str, str, float]] = []
    for scheduled in realizer.scheduled:
        behaviour = scheduled.behaviour
        if behaviour.kind != "speech" or _text_and_language(behaviour) not in who.estimated:
            continue
        utterance = utterance_of(behaviour, who)
        if utterance is None:
            waiting.add(_text_and_language(behaviour))
            continue
        known.add(_text_and_language(behaviour))
        if scheduled.key in who.late:
            who.late[scheduled.key] = now
        start = who.late.get(scheduled.key, scheduled.start)
        marks = dict(_times_of_marks(behaviour, utterance))
        for sync, time in {**marks, "end": utterance.duration}.items():
            moves.append((scheduled.block, behaviour.id, sync, start + time))
    realizer.retime_all(moves)
    # What is not scheduled any more is over, or is estimated again when it starts.
    who.estimated &= waiting - known


def utterance_of(behaviour: Behaviour, who: RealizationContext) -> Utterance | None:
    """Return what the voice says for a speech; None if it has not answered."""
    return who.utterance_of(*_text_and_language(behaviour))


def estimate(text: str) -> Utterance:
    """Return an utterance with the words of a text at times that a voice might take.

    >>> estimate("No, never.").words
    (Word(text='No,', start=0.0, end=0.18, offset=0), Word(text='never.', start=0.33, end=0.69, offset=4))
    """  # noqa: E501
    words, at, offset = list[Word](), 0.0, 0
    for word in text.split():
        offset = text.index(word, offset)
        letters = sum(letter.isalnum() for letter in word)
        end = at + WORD_S + LETTER_S * letters
        words.append(Word(word, round(at, 6), round(end, 6), offset))
        at, offset = end + PAUSE_S.get(word[-1], 0.0), offset + len(word)
    return Utterance(text, "", words[-1].end if words else SHORTEST_S, tuple(words))


def _times_of_marks(behaviour: Behaviour, utterance: Utterance) -> Iterator[tuple[str, float]]:
    """Yield when the next word after each mark begins [s]; the end after the last word."""
    offsets = [word.offset for word in utterance.words]
    starts = [*(word.start for word in utterance.words), utterance.duration]
    for mark in behaviour.marks:
        yield mark.id, starts[bisect_left(offsets, mark.at)]


def _text_and_language(behaviour: Behaviour) -> tuple[str, str]:
    """Return what a voice is asked for: text and language."""
    return behaviour.text, behaviour.get("lang", namespace=XML)
