"""The 24 emotions of Ortony, Clore and Collins on a face and in a body.

Egges, *Real-time Animation of Interactive Virtual Humans*, 2006, section 5.3: table 5.2 for the
face, eqs. 5.14 and 5.15 for the body. The faces and places of the emotions are those of the table
in `cubeling.affect.labels`; the places are ALMA's (Gebhard 2005).
"""

from collections.abc import Mapping
from types import MappingProxyType

from cubeling.affect.emotion import NEUTRAL, Emotion
from cubeling.affect.errors import AffectError
from cubeling.affect.labels import WORD_TABLE, Face
from cubeling.affect.regions import on_disc

_ROWS = {row.word: row for row in WORD_TABLE if row.set == "occ" and row.face != "neutral"}

OCC_FACES: Mapping[str, Face] = MappingProxyType({word: row.face for word, row in _ROWS.items()})
"""Which of Ekman's six faces shows each of the 24 emotions."""


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
    shown: dict[Face, float] = dict.fromkeys(OCC_FACES.values(), 0.0)
    for word, intensity in _check_intensities(intensities).items():
        shown[OCC_FACES[word]] = max(shown[OCC_FACES[word]], intensity)
    return shown


def shown_emotion(intensities: Mapping[str, float]) -> Emotion:
    """Return what a character shows of intensities of emotions, 0…1.

    Its place is the sum of those of the emotions, at most on the rim of the disc; its word that of
    the face that is shown most.

    >>> shown_emotion({"fear-confirmed": 1.0})
    Emotion(valence=-0.5, arousal=-0.3, word='afraid')

    Raises
    ------
    AffectError
        An emotion is not one of the 24.
    """
    known = _check_intensities(intensities)
    if not any(known.values()):
        return NEUTRAL
    place = on_disc(
        sum(_ROWS[word].valence * intensity for word, intensity in known.items()),
        sum(_ROWS[word].arousal * intensity for word, intensity in known.items()),
    )
    faces = face_intensities(known)
    return Emotion(place.valence, place.arousal, max(faces, key=lambda face: faces[face]))


def _check_intensities(intensities: Mapping[str, float]) -> dict[str, float]:
    """Return intensities within 0…1 of emotions that are known."""
    for word in intensities:
        if word not in _ROWS:
            raise AffectError(f"{word!r} is not one of the 24 emotions: {', '.join(_ROWS)}")
    return {word: min(max(value, 0.0), 1.0) for word, value in intensities.items()}
