"""The 24 emotions: those of Ortony, Clore and Collins (1988), and surprise and disgust.

Egges, *Real-time Animation of Interactive Virtual Humans*, 2006: section 5.2 for how strongly a
personality responds to each; section 5.3 for the face (table 5.2) and the body (eqs. 5.14, 5.15).
The faces and places of the emotions are those of the table in `cubeling.affect.labels`; places and
dominance are ALMA's (Gebhard 2005), as the thesis shows its own in a figure only.
"""

from collections.abc import Mapping
from types import MappingProxyType

from cubeling.affect.emotion import Emotion
from cubeling.affect.errors import AffectError
from cubeling.affect.labels import WORD_TABLE, Face
from cubeling.affect.regions import on_disc
from cubeling.affect.traits import (
    MEHRABIAN_ROWS,
    THESIS_NEGATIVE_ROW,
    THESIS_POSITIVE_ROW,
    TraitRow,
)

_ROWS = {row.word: row for row in WORD_TABLE if row.set == "occ" and row.face != "neutral"}

OCC_FACES: Mapping[str, Face] = MappingProxyType({word: row.face for word, row in _ROWS.items()})
"""Which of Ekman's six faces shows each of the 24 emotions."""

OCC_PLACES: Mapping[str, tuple[float, float]] = MappingProxyType(
    {word: (row.valence, row.arousal) for word, row in _ROWS.items()}
)
"""(valence, arousal) of each: the columns of D (eq. 5.14), whose rows stand the other way round."""

DOMINANCE: Mapping[str, float] = MappingProxyType(
    {
        **{"admiration": -0.20, "anger": 0.25, "disappointment": -0.40, "distress": -0.50},
        **{"fear": -0.43, "fear-confirmed": -0.70, "gloating": -0.10, "gratification": 0.40},
        **{"gratitude": -0.30, "happy-for": 0.20, "hate": 0.30, "hope": -0.10, "joy": 0.10},
        **{"love": 0.20, "pity": -0.50, "pride": 0.30, "relief": 0.40, "remorse": -0.60},
        **{"reproach": 0.40, "resentment": -0.20, "satisfaction": 0.40, "shame": -0.60},
        # ALMA has no such words: for disgust its "disliking", for surprise nothing.
        **{"disgust": 0.10, "surprise": 0.0},
    }
)
"""The third axis of ALMA's places, from submissive, −1, to dominant, 1."""

InfluenceMatrix = Mapping[str, TraitRow]
"""P₀ (eq. 5.8): a row for each of the 24 emotions, a column for each trait of `Ocean`."""

TWO_ROWS: InfluenceMatrix = MappingProxyType(
    {
        word: THESIS_POSITIVE_ROW if valence > 0.0 else THESIS_NEGATIVE_ROW
        for word, (valence, _) in OCC_PLACES.items()
    }
)
"""One row for all pleasant emotions and one for all others (specification S17)."""


def _alma_matrix() -> InfluenceMatrix:
    matrix = {}
    for word, (valence, arousal) in OCC_PLACES.items():
        point = valence, arousal, DOMINANCE[word]
        row = [
            sum(p * axis[trait] for p, axis in zip(point, MEHRABIAN_ROWS, strict=True))
            for trait in range(5)
        ]
        shift = (1.0 - sum(row)) / 5.0
        matrix[word] = TraitRow(*(each + shift for each in row))
    return MappingProxyType(matrix)


ALMA_MATRIX = _alma_matrix()
"""The usual P₀, which is not of the thesis: ALMA's places times Mehrabian's trait equations.

So people feel most readily what lies where their temperament does. The product alone is negative
for nearly all that is unpleasant, and nobody would ever be sad: each row is shifted to a sum of 1
(ours), by which who has every trait at one half responds by half to everything, and who has none,
to nothing.
"""


def check_words(words: Mapping[str, object]) -> None:
    """Raise AffectError unless every key is one of the 24 emotions."""
    for word in words:
        if word not in OCC_PLACES:
            raise AffectError(f"{word!r} is not one of the 24 emotions: {', '.join(OCC_PLACES)}")


def face_intensities(intensities: Mapping[str, float]) -> dict[Face, float]:
    """Return how strongly each of the six faces is shown, 0…1, for intensities of emotions, 0…1.

    The strongest emotion of a face counts.

    >>> face_intensities({"joy": 0.4, "pride": 0.7, "fear": 0.2})["happy"]
    0.7

    Raises
    ------
    AffectError
        An emotion is not one of the 24.
    """
    check_words(intensities)
    shown: dict[Face, float] = dict.fromkeys(OCC_FACES.values(), 0.0)
    for word, intensity in intensities.items():
        shown[OCC_FACES[word]] = max(shown[OCC_FACES[word]], intensity)
    return shown


def activation_evaluation(
    intensities: Mapping[str, float], rest: tuple[float, float] = (0.0, 0.0)
) -> Emotion:
    """Return the place in the plane of intensities of emotions, 0…1 (eq. 5.15).

    It is the sum of their places and of the one at rest, (valence, arousal), at most on the rim of
    the disc.

    >>> activation_evaluation({"joy": 0.5, "surprise": 0.5})
    Emotion(valence=0.25, arousal=0.5, word=None, intensity=None)

    Raises
    ------
    AffectError
        An emotion is not one of the 24.
    """
    check_words(intensities)
    felt = [(OCC_PLACES[word], intensity) for word, intensity in intensities.items()]
    return on_disc(
        rest[0] + sum(valence * intensity for (valence, _), intensity in felt),
        rest[1] + sum(arousal * intensity for (_, arousal), intensity in felt),
    )
