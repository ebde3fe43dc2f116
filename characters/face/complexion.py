"""Complexion: how much blood an emotion brings to the skin of the face: blush and pallor.

People flush in anger, pleasure and shame, and pale in fear (Drummond, "Correlates of facial
flushing and pallor in anger-provoking situations", 1997; Nakajima, Minami and Nakauchi,
"Interaction between facial expression and color", 2017). The colour is that of haemoglobin, after
Jimenez et al., "A practical appearance model for dynamic facial color", 2010: pigments are vectors
of optical density (Tsumura et al. 2003), so they multiply the colour of any skin. All amounts and
times are ours; of Huang 2013 this is no part.
"""

from collections.abc import Mapping

from cubeling.affect import Emotion
from cubeling.affect.labels import Face
from cubeling.affect.words import WORD_FACES, closest_word
from cubeling.characters.smoothing import low_pass

BLOOD_OF_FACE: Mapping[Face, float] = {
    "neutral": 0.0,
    "happy": 0.45,
    "angry": 1.0,
    "afraid": -1.0,
    "sad": -0.6,
    "disgusted": -0.3,
    "surprised": 0.0,
}
"""Blood in the skin for each of Ekman's faces at its full strength: -1 pale … 1 flushed."""

BLOOD_OF_WORD: Mapping[str, float] = {
    "shame": 1.0,
    "love": 0.9,
    "excited": 0.8,
    "content": 0.1,
    "bored": 0.0,
    "relief": 0.0,
}
"""The same for words that differ from others with their face."""

RISE_S, FALL_S = 2.0, 6.0
"""Time constants with which vessels of the skin change, and return to rest [s]."""

HAEMOGLOBIN_DENSITY = (0.052, 0.50, 0.34)
"""Optical density that full flush adds in linear red, green and blue (natural logarithm).

Ratios: molar extinction of oxygenated haemoglobin (S. Prahl's compilation, 1999), whose means over
590…630, 520…570 and 440…480 nm are 4,100, 39,600 and 53,900; we let blue light come back from half
the depth. The amount is ours: +12 in CIELAB's a* in the middle of the bundled human's cheek, a
strong blush, as on the table the whole face is forty pixels high.
"""

PALLOR_SHARE = 0.6
"""Density that full pallor takes away, as a share of the above: skin at rest has little to lose."""

NEGLIGIBLE_BLOOD = 1e-3
"""A smaller change of blood is not visible."""


def blood_of(emotion: Emotion | None) -> float:
    """Return the blood in the skin that an emotion leads to if it lasts, -1…1.

    >>> blood_of(Emotion(-0.6, 0.8, "afraid")), blood_of(Emotion(0.0, 0.0, "neutral"))
    (-1.0, 0.0)
    """
    if emotion is None:
        return 0.0
    word = emotion.word if emotion.word in WORD_FACES else closest_word(_PLACED, emotion)
    blood = BLOOD_OF_WORD.get(word or "", BLOOD_OF_FACE[WORD_FACES[word or "neutral"]])
    return blood * emotion.strength


_PLACED = ("neutral", "happy", "angry", "afraid", "sad", "surprised")


class Complexion:
    """The blood in the skin of one face: flush and pallor, each of which rises and falls slowly."""

    def __init__(self) -> None:
        self._flush = self._pallor = 0.0
        self._time: float | None = None

    @property
    def blood(self) -> float:
        """Blood in the skin: -1 pale … 1 flushed."""
        blood = self._flush - self._pallor
        return blood if abs(blood) > NEGLIGIBLE_BLOOD else 0.0

    def update(self, time: float, emotion: Emotion | None) -> float:
        """Advance to a time [s] under an emotion and return the blood, -1…1.

        The first call starts at rest. Time that runs backwards counts as none.
        """
        elapsed = 0.0 if self._time is None else max(time - self._time, 0.0)
        self._time = time
        target = blood_of(emotion)
        self._flush = _follow(self._flush, max(target, 0.0), elapsed)
        self._pallor = _follow(self._pallor, max(-target, 0.0), elapsed)
        return self.blood


def _follow(value: float, target: float, elapsed: float) -> float:
    return low_pass(value, target, elapsed, RISE_S if target > value else FALL_S)


def added_density(blood: float) -> tuple[float, float, float]:
    """Return the optical density that blood adds to skin in linear RGB, for -1…1.

    >>> added_density(0.0)
    (0.0, 0.0, 0.0)
    """
    red, green, blue = HAEMOGLOBIN_DENSITY
    share = blood if blood > 0.0 else PALLOR_SHARE * blood
    return share * red, share * green, share * blue
