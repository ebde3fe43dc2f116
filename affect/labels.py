"""Label sets: words for emotions, and where each lies in the plane of valence and arousal."""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Literal, NamedTuple

from cubeling.affect.emotion import Emotion
from cubeling.affect.errors import AffectError
from cubeling.affect.hysteresis import Label, next_label

Face = Literal["neutral", "happy", "sad", "angry", "surprised", "afraid", "disgusted"]

LABEL_OF_FACE: Mapping[Face, Label] = MappingProxyType(
    {
        "neutral": "neutral",
        "happy": "happy",
        "sad": "neutral",
        "angry": "angry",
        "surprised": "neutral",
        "afraid": "angry",
        "disgusted": "angry",
    }
)
"""What a robot that knows only the three labels of the thesis shows for each face. Anger, fear and
disgust are shown as angry: unpleasant and aroused. Sadness and surprise are shown as neutral:
neither the angry nor the happy motion fits them."""


class Word(NamedTuple):
    """A word for an emotion: one row of the table."""

    word: str
    """As players and settings write it, in small letters; unique in the table."""

    valence: float
    """From unpleasant, −1, to pleasant, 1."""

    arousal: float
    """From calm, −1, to excited, 1."""

    face: Face
    """Which of Ekman's faces shows it (specification S18, table 5.2; other words are ours)."""

    set: str
    """The label set that it belongs to; "words" for what robots call their moods."""


_CIRCLE_RADIUS = 0.8
_DIAGONAL_OFFSET = round(_CIRCLE_RADIUS * math.sqrt(0.5), 3)

WORD_TABLE: tuple[Word, ...] = (
    # The three of the thesis (Fernández-Baena 2015, section 5.3). Robots receive these places;
    # which of the three is shown depends on the valence alone (`next_label`).
    Word("neutral", 0.0, 0.0, "neutral", "thesis"),
    Word("happy", 0.7, 0.6, "happy", "thesis"),
    Word("angry", -0.7, 0.6, "angry", "thesis"),
    # Words that robots have for their moods; afraid and disgusted as in OCC, the others are ours.
    Word("sad", -0.6, -0.4, "sad", "words"),
    Word("surprised", 0.1, 0.8, "surprised", "words"),
    Word("afraid", -0.64, 0.6, "afraid", "words"),
    Word("disgusted", -0.6, 0.3, "disgusted", "words"),
    Word("excited", 0.6, 0.8, "happy", "words"),
    Word("content", 0.6, -0.3, "happy", "words"),
    Word("calm", 0.3, -0.6, "neutral", "words"),
    Word("sleepy", 0.0, -0.9, "neutral", "words"),
    Word("bored", -0.4, -0.6, "sad", "words"),
    # The eight directions of the circumplex (Russell 1980), 45° apart; the
    # radius and some of the words are ours.
    Word("neutral", 0.0, 0.0, "neutral", "circumplex"),
    Word("pleased", _CIRCLE_RADIUS, 0.0, "happy", "circumplex"),
    Word("excited", _DIAGONAL_OFFSET, _DIAGONAL_OFFSET, "happy", "circumplex"),
    Word("alert", 0.0, _CIRCLE_RADIUS, "surprised", "circumplex"),
    Word("distressed", -_DIAGONAL_OFFSET, _DIAGONAL_OFFSET, "angry", "circumplex"),
    Word("displeased", -_CIRCLE_RADIUS, 0.0, "angry", "circumplex"),
    Word("depressed", -_DIAGONAL_OFFSET, -_DIAGONAL_OFFSET, "sad", "circumplex"),
    Word("sleepy", 0.0, -_CIRCLE_RADIUS, "neutral", "circumplex"),
    Word("relaxed", _DIAGONAL_OFFSET, -_DIAGONAL_OFFSET, "neutral", "circumplex"),
    # Ekman's six basic emotions (1992). The plane hardly separates fear from anger (ALMA's places
    # are 0.13 apart; they differ in dominance), so ours are further apart: fear has more arousal.
    Word("neutral", 0.0, 0.0, "neutral", "ekman"),
    Word("happy", 0.7, 0.4, "happy", "ekman"),
    Word("sad", -0.6, -0.5, "sad", "ekman"),
    Word("angry", -0.75, 0.4, "angry", "ekman"),
    Word("surprised", 0.1, 0.8, "surprised", "ekman"),
    Word("afraid", -0.4, 0.8, "afraid", "ekman"),
    Word("disgusted", -0.75, -0.05, "disgusted", "ekman"),
    # The 22 emotions of Ortony, Clore and Collins (1988), and surprise and disgust; places:
    # pleasure and arousal of ALMA (Gebhard 2005), surprise and disgust by specification S18. Where
    # several share a place, the first stands for all.
    Word("neutral", 0.0, 0.0, "neutral", "occ"),
    Word("joy", 0.4, 0.2, "happy", "occ"),
    Word("happy-for", 0.4, 0.2, "happy", "occ"),
    Word("gratitude", 0.4, 0.2, "happy", "occ"),
    Word("gratification", 0.6, 0.5, "happy", "occ"),
    Word("admiration", 0.5, 0.3, "happy", "occ"),
    Word("pride", 0.4, 0.3, "happy", "occ"),
    Word("love", 0.3, 0.1, "happy", "occ"),
    Word("hope", 0.2, 0.2, "happy", "occ"),
    Word("satisfaction", 0.3, -0.2, "happy", "occ"),
    Word("relief", 0.2, -0.3, "happy", "occ"),
    Word("gloating", 0.3, -0.3, "happy", "occ"),
    Word("distress", -0.4, -0.2, "sad", "occ"),
    Word("pity", -0.4, -0.2, "sad", "occ"),
    Word("disappointment", -0.3, 0.1, "sad", "occ"),
    Word("shame", -0.3, 0.1, "sad", "occ"),
    Word("remorse", -0.3, 0.1, "sad", "occ"),
    Word("resentment", -0.2, -0.3, "sad", "occ"),
    Word("anger", -0.51, 0.59, "angry", "occ"),
    Word("reproach", -0.3, -0.1, "angry", "occ"),
    Word("hate", -0.6, 0.6, "angry", "occ"),
    Word("surprise", 0.1, 0.8, "surprised", "occ"),
    Word("fear", -0.64, 0.6, "afraid", "occ"),
    Word("fear-confirmed", -0.5, -0.3, "afraid", "occ"),
    Word("disgust", -0.6, 0.3, "disgusted", "occ"),
)
"""Every word, set by set."""


@dataclass(frozen=True)
class LabelSet:
    """The words that describe an emotion, and how one follows another."""

    name: str
    """Its name, as personalities refer to it."""

    places: Mapping[str, tuple[float, float]]
    """(valence, arousal) of every label."""

    hub: str | None = None
    """The label between any two others; None if there is none."""

    by_valence: bool = False
    """Whether valence alone decides, by the thresholds of the thesis."""

    start: str = "neutral"
    """The label before any emotion has been felt; one of the set's words."""

    def next(self, label: str, emotion: Emotion, hysteresis: float) -> str:
        """Return the label that follows `label` at an emotion.

        It is the one with the nearest place, once the emotion is `hysteresis` past the border:
        noise of a smaller amplitude never switches back and forth. (By valence: `next_label`.)

        >>> LABEL_SETS["circumplex"].next("neutral", Emotion(0.5, 0.5), 0.05)
        'excited'
        """
        if self.by_valence:
            return next_label(label, emotion.valence, hysteresis)
        point = (emotion.valence, emotion.arousal)
        nearest = min(self.places, key=lambda word: math.dist(self.places[word], point))
        # Across the border between two places the difference of distances grows twice as fast.
        lead = math.dist(self.places[label], point) - math.dist(self.places[nearest], point)
        return nearest if lead > 2.0 * hysteresis else label


def _label_set(name: str, hub: str | None = None, by_valence: bool = False) -> LabelSet:
    places = {row.word: (row.valence, row.arousal) for row in WORD_TABLE if row.set == name}
    return LabelSet(name, MappingProxyType(places), hub, by_valence)


LABEL_SETS: Mapping[str, LabelSet] = MappingProxyType(
    {
        "thesis": _label_set("thesis", hub="neutral", by_valence=True),
        "circumplex": _label_set("circumplex"),
        "ekman": _label_set("ekman", hub="neutral"),
        "occ": _label_set("occ"),
    }
)
"""Every label set by its name."""


def label_set(name: str) -> LabelSet:
    """Return a label set; raise AffectError if there is none of that name."""
    if name not in LABEL_SETS:
        raise AffectError(f"there is no label set {name!r}: choose one of {', '.join(LABEL_SETS)}")
    return LABEL_SETS[name]
