"""Words for emotions: where each lies in the plane, and which of several is closest."""

import math
from collections.abc import Sequence
from types import MappingProxyType

from cubeling.affect.emotion import Emotion
from cubeling.affect.labels import LABEL_OF_FACE, WORD_TABLE

WORD_PLACES = MappingProxyType(
    {row.word: (row.valence, row.arousal) for row in reversed(WORD_TABLE)}  # the first row counts
)
"""(valence, arousal) of every known word; `cubeling.affect.labels` gives the sources."""

WORD_FACES = MappingProxyType({row.word: row.face for row in reversed(WORD_TABLE)})
"""Which of Ekman's faces shows each word."""

WORD_LABELS = MappingProxyType({word: LABEL_OF_FACE[face] for word, face in WORD_FACES.items()})
"""What a robot that knows only neutral, happy and angry shows for each word."""


def closest_word(words: Sequence[str], emotion: Emotion) -> str | None:
    """Return which of the words that a robot or character has comes closest to an emotion.

    The emotion's own word, if it is among them. Else one with the same face; else one that a robot
    with three moods shows in the same way (`WORD_LABELS`); else any; of several, the one nearest to
    the place of the emotion's word. For an emotion without a known word, the word nearest to its
    place. None if none of the words is known.

    >>> closest_word(("neutral", "happy", "angry"), Emotion(-0.5, -0.3, "sad"))
    'neutral'
    >>> closest_word(("neutral", "happy", "angry"), Emotion(-0.9, 0.9))
    'angry'
    """
    own = emotion.word
    if own in words:
        return own
    known = [word for word in words if word in WORD_PLACES]
    if own is None or own not in WORD_PLACES:
        place = (emotion.valence, emotion.arousal)
        return min(known, key=lambda word: math.dist(WORD_PLACES[word], place), default=None)

    def difference(word: str) -> tuple[bool, bool, float]:
        other_face = WORD_FACES[word] != WORD_FACES[own]
        other_label = WORD_LABELS[word] != WORD_LABELS[own]
        return other_face, other_label, math.dist(WORD_PLACES[word], WORD_PLACES[own])

    return min(known, key=difference, default=None)
