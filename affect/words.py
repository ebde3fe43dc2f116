"""Words for emotions, and where each lies in the plane of valence and arousal."""

import math
from collections.abc import Sequence
from types import MappingProxyType

from affect.emotion import Emotion
from affect.labels import SIMPLE_FACES, TABLE, Simple

PLACES = MappingProxyType(
    {row.word: (row.valence, row.arousal) for row in reversed(TABLE)}  # the first row counts
)
"""(valence, arousal) of every word that is known here; `affect.labels` says whence."""

FACES = MappingProxyType({row.word: row.face for row in reversed(TABLE)})
"""Which of Ekman's faces shows each word."""

SIMPLE = MappingProxyType({word: SIMPLE_FACES[face] for word, face in FACES.items()})
"""What a robot shows for each word that knows neutral, happy and angry only."""


def closest_word(words: Sequence[str], emotion: Emotion, label: str | None = None) -> str | None:
    """Return which of a robot's words comes closest to a feeling.

    The label itself where the robot has it. Else one with the same face as the label; else one that
    a robot with three moods would show alike (`SIMPLE`); else any; of several, the one whose place
    is nearest to the label's. Without a label that is known, the nearest to the emotion. None if
    the robot has no word that is known.

    >>> closest_word(("neutral", "happy", "angry"), Emotion(-0.5, -0.3), "sad")
    'neutral'
    >>> closest_word(("neutral", "happy", "angry"), Emotion(-0.9, 0.9))
    'angry'
    """
    if label in words:
        return label
    known = [word for word in words if word in PLACES]
    if label is None or label not in PLACES:
        place = (emotion.valence, emotion.arousal)
        return min(known, key=lambda word: math.dist(PLACES[word], place), default=None)

    def strangeness(word: str) -> tuple[bool, bool, float]:
        other_face, otherwise = FACES[word] != FACES[label], SIMPLE[word] != SIMPLE[label]
        return other_face, otherwise, math.dist(PLACES[word], PLACES[label])

    return min(known, key=strangeness, default=None)


def simple_mood(emotion: Emotion, label: str | None = None) -> Simple:
    """Return which of neutral, happy and angry a feeling is shown as.

    >>> simple_mood(Emotion(0.6, 0.7), "excited")
    'happy'
    """
    if label is not None and label in SIMPLE:
        return SIMPLE[label]
    word = closest_word(("neutral", "happy", "angry"), emotion)
    assert word is not None
    return SIMPLE[word]
