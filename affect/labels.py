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
disgust are shown as angry: unpleasant and aroused. Of the three labels that is the nearest to fear
(ALMA's place is .13 from anger's by valence and arousal, and with dominance .69, but .98 from
neutral): such a robot shows how unpleasant and how excited it is, and cannot show who is stronger.
Sadness and surprise are shown as neutral: neither the angry nor the happy motion fits them."""


class EmotionWord(NamedTuple):
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

WORD_TABLE: tuple[EmotionWord, ...] = (
    # The three of the thesis (Fernández-Baena 2015, section 5.3). Robots receive these places;
    # which of the three is shown depends on the valence alone (`next_label`).
    EmotionWord("neutral", 0.0, 0.0, "neutral", "thesis"),
    EmotionWord("happy", 0.7, 0.6, "happy", "thesis"),
    EmotionWord("angry", -0.7, 0.6, "angry", "thesis"),
    # Words that robots have for their moods; afraid and disgusted as in OCC, the others are ours.
    EmotionWord("sad", -0.6, -0.4, "sad", "words"),
    EmotionWord("surprised", 0.1, 0.8, "surprised", "words"),
    EmotionWord("afraid", -0.64, 0.6, "afraid", "words"),
    EmotionWord("disgusted", -0.6, 0.3, "disgusted", "words"),
    EmotionWord("excited", 0.6, 0.8, "happy", "words"),
    EmotionWord("content", 0.6, -0.3, "happy", "words"),
    EmotionWord("calm", 0.3, -0.6, "neutral", "words"),
    EmotionWord("sleepy", 0.0, -0.9, "neutral", "words"),
    EmotionWord("bored", -0.4, -0.6, "sad", "words"),
    # The eight directions of the circumplex (Russell 1980), 45° apart; the
    # radius and some of the words are ours.
    EmotionWord("neutral", 0.0, 0.0, "neutral", "circumplex"),
    EmotionWord("pleased", _CIRCLE_RADIUS, 0.0, "happy", "circumplex"),
    EmotionWord("excited", _DIAGONAL_OFFSET, _DIAGONAL_OFFSET, "happy", "circumplex"),
    EmotionWord("alert", 0.0, _CIRCLE_RADIUS, "surprised", "circumplex"),
    EmotionWord("distressed", -_DIAGONAL_OFFSET, _DIAGONAL_OFFSET, "angry", "circumplex"),
    EmotionWord("displeased", -_CIRCLE_RADIUS, 0.0, "angry", "circumplex"),
    EmotionWord("depressed", -_DIAGONAL_OFFSET, -_DIAGONAL_OFFSET, "sad", "circumplex"),
    EmotionWord("sleepy", 0.0, -_CIRCLE_RADIUS, "neutral", "circumplex"),
    EmotionWord("relaxed", _DIAGONAL_OFFSET, -_DIAGONAL_OFFSET, "neutral", "circumplex"),
    # Ekman's six basic emotions (1992). The plane hardly separates fear from anger (ALMA's places
    # are 0.13 apart; they differ in dominance), so ours are further apart: fear has more arousal.
    EmotionWord("neutral", 0.0, 0.0, "neutral", "ekman"),
    EmotionWord("happy", 0.7, 0.4, "happy", "ekman"),
    EmotionWord("sad", -0.6, -0.5, "sad", "ekman"),
    EmotionWord("angry", -0.75, 0.4, "angry", "ekman"),
    EmotionWord("surprised", 0.1, 0.8, "surprised", "ekman"),
    EmotionWord("afraid", -0.4, 0.8, "afraid", "ekman"),
    EmotionWord("disgusted", -0.75, -0.05, "disgusted", "ekman"),
    # The 22 emotions of Ortony, Clore and Collins (1988), and surprise and disgust; places:
    # pleasure and arousal of ALMA (Gebhard 2005), surprise and disgust by specification S18. Where
    # several share a place, the first stands for all.
    EmotionWord("neutral", 0.0, 0.0, "neutral", "occ"),
    EmotionWord("joy", 0.4, 0.2, "happy", "occ"),
    EmotionWord("happy-for", 0.4, 0.2, "happy", "occ"),
    EmotionWord("gratitude", 0.4, 0.2, "happy", "occ"),
    EmotionWord("gratification", 0.6, 0.5, "happy", "occ"),
    EmotionWord("admiration", 0.5, 0.3, "happy", "occ"),
    EmotionWord("pride", 0.4, 0.3, "happy", "occ"),
    EmotionWord("love", 0.3, 0.1, "happy", "occ"),
    EmotionWord("hope", 0.2, 0.2, "happy", "occ"),
    EmotionWord("satisfaction", 0.3, -0.2, "happy", "occ"),
    EmotionWord("relief", 0.2, -0.3, "happy", "occ"),
    EmotionWord("gloating", 0.3, -0.3, "happy", "occ"),
    EmotionWord("distress", -0.4, -0.2, "sad", "occ"),
    EmotionWord("pity", -0.4, -0.2, "sad", "occ"),
    EmotionWord("disappointment", -0.3, 0.1, "sad", "occ"),
    EmotionWord("shame", -0.3, 0.1, "sad", "occ"),
    EmotionWord("remorse", -0.3, 0.1, "sad", "occ"),
    EmotionWord("resentment", -0.2, -0.3, "sad", "occ"),
    EmotionWord("anger", -0.51, 0.59, "angry", "occ"),
    EmotionWord("reproach", -0.3, -0.1, "angry", "occ"),
    EmotionWord("hate", -0.6, 0.6, "angry", "occ"),
    EmotionWord("surprise", 0.1, 0.8, "surprised", "occ"),
    EmotionWord("fear", -0.64, 0.6, "afraid", "occ"),
    EmotionWord("fear-confirmed", -0.5, -0.3, "afraid", "occ"),
    EmotionWord("disgust", -0.6, 0.3, "disgusted", "occ"),
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
