"""Words for emotions, and where each lies in the plane of valence and arousal."""

import math
from collections.abc import Sequence
from types import MappingProxyType

from robot.emotion import Emotion
from robot.feeling.labels import TABLE, Simple

PLACES = MappingProxyType(
    {row.word: (row.valence, row.arousal) for row in reversed(TABLE)}  # the first row counts
)
"""(valence, arousal) of every word that is known here; `robot.feeling.labels` says whence."""

SIMPLE = MappingProxyType({row.word: row.simple for row in reversed(TABLE)})
"""What a robot shows for each word that knows neutral, happy and angry only."""


def closest_word(words: Sequence[str], emotion: Emotion, label: str | None = None) -> str | None:
    """Return which of a robot's words comes closest to a feeling.

    The label itself where the robot has it; else, of the words that are as good as it on a robot
    with three moods (`SIMPLE`), the one whose place is nearest to the label's; else the nearest of
    all. Without a label that is known, the nearest to the emotion. None if the robot has no word
    that is known.

    >>> closest_word(("neutral", "happy", "angry"), Emotion(-0.5, -0.3), "sad")
    'neutral'
    >>> closest_word(("neutral", "happy", "angry"), Emotion(-0.9, 0.9))
    'angry'
    """
    if label in words:
        return label
    known = [word for word in words if word in PLACES]
    place = PLACES.get(label or "", (emotion.valence, emotion.arousal))
    alike = [word for word in known if SIMPLE[word] == SIMPLE.get(label or "")]
    return min(alike or known, key=lambda word: math.dist(PLACES[word], place), default=None)


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
