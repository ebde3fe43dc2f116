"""Words for emotions, and where each lies in the plane of valence and arousal."""

import math
from collections.abc import Sequence
from types import MappingProxyType

from robot.emotion import Emotion

PLACES = MappingProxyType(
    {
        "neutral": (0.0, 0.0),
        "happy": (0.7, 0.6),
        "angry": (-0.7, 0.6),
        "sad": (-0.6, -0.4),
        "surprised": (0.1, 0.8),
        "afraid": (-0.64, 0.6),
        "disgusted": (-0.6, 0.3),
        "excited": (0.6, 0.8),
        "content": (0.6, -0.3),
        "calm": (0.3, -0.6),
        "sleepy": (0.0, -0.9),
        "bored": (-0.4, -0.6),
    }
)
"""(valence, arousal) of every word that is known here."""


def closest_word(words: Sequence[str], emotion: Emotion, label: str | None = None) -> str | None:
    """Return which of a robot's words comes closest to a feeling.

    The label itself where the robot has it; else the word whose place is nearest to the label's,
    or, without a label that is known, to the emotion. None if the robot has no word that is known.

    >>> closest_word(("neutral", "happy", "angry"), Emotion(-0.5, -0.3), "sad")
    'neutral'
    >>> closest_word(("neutral", "happy", "angry"), Emotion(-0.9, 0.9))
    'angry'
    """
    if label in words:
        return label
    place = PLACES.get(label or "", (emotion.valence, emotion.arousal))
    known = [word for word in words if word in PLACES]
    return min(known, key=lambda word: math.dist(PLACES[word], place), default=None)
