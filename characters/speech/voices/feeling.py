"""How an emotion sounds: the rate, pitch and pitch range of a voice.

The signs are those of Scherer, "Vocal communication of emotion", 2003, table 1: joy and anger are
faster, higher and wider, sadness is slower, lower and narrower. The sizes are ours.
"""

from cubeling.affect import Emotion
from cubeling.characters.speech.voices.voice import Manner

RATE, PITCH, RANGE = (0.03, 0.18), (0.06, 0.12), (0.18, 0.40)
"""How much of each a valence of 1 and an arousal of 1 add, as a part."""


def manner_of(emotion: Emotion | None) -> Manner:
    """Return how a text is spoken in an emotion.

    >>> manner_of(None)
    Manner(rate=1.0, pitch=1.0, range=1.0, speaker=0)
    >>> sad = manner_of(Emotion(-0.8, -0.4, "sad"))
    >>> sad.rate < 1.0 and sad.pitch < 1.0 and sad.range < 1.0
    True
    """
    if emotion is None:
        return Manner()
    place = emotion.valence, emotion.arousal
    rate, pitch, spread = (1.0 + _dot(place, part) for part in (RATE, PITCH, RANGE))
    return Manner(rate, pitch, spread)


def _dot(place: tuple[float, float], part: tuple[float, float]) -> float:
    return place[0] * part[0] + place[1] * part[1]
