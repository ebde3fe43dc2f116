"""Regions of the plane of valence and arousal, for what belongs to some emotions only.

Source: Egges, *Real-time Animation of Interactive Virtual Humans*, 2006, section 4.1. His plane is
the disc of evaluation (our valence) and activation (our arousal).
"""

import math
from dataclasses import dataclass

from cubeling.affect.emotion import Emotion
from cubeling.affect.errors import AffectError
from cubeling.affect.words import WORD_PLACES


@dataclass(frozen=True)
class RegionBox:
    """A rectangle of the plane."""

    valence: tuple[float, float]
    """Least and greatest valence, −1…1."""

    arousal: tuple[float, float]
    """Least and greatest arousal, −1…1."""

    def contains(self, emotion: Emotion, margin: float = 0.0) -> bool:
        """Return whether an emotion belongs to it, or is nearer to it than a margin."""
        across = _within(emotion.valence, self.valence, margin)
        return across and _within(emotion.arousal, self.arousal, margin)


@dataclass(frozen=True)
class Sector:
    """A sector of a ring around the middle of the plane."""

    middle: float
    """Its direction [rad]: 0 is pleasant, π/2 aroused."""

    width: float
    """Angle between its sides [rad]."""

    inner: float
    """Radius from which it begins; it has no outer end."""

    def contains(self, emotion: Emotion, margin: float = 0.0) -> bool:
        """Return whether an emotion belongs to it, or is nearer to it than a margin."""
        radius = math.hypot(emotion.valence, emotion.arousal)
        angle = math.atan2(emotion.arousal, emotion.valence) - self.middle
        beside = abs(math.remainder(angle, math.tau)) - self.width / 2
        return radius >= self.inner - margin and beside * radius <= margin


Region = RegionBox | Sector
"""A part of the plane of valence and arousal that belongs to one word."""

NEUTRAL_RADIUS = 0.25
"""Emotions nearer to the middle of the plane than this are neutral."""

SECTOR_WORDS = (
    *("pleased", "happy", "alert", "angry"),
    *("displeased", "depressed", "sleepy", "relaxed"),
)
"""The eight sectors of the plane, by the words in their middle, from 0 on by an eighth."""


def region_of(word: str) -> Region:
    """Return the region of a word for an emotion: its eighth of the plane, or the middle.

    >>> region_of("sad") == region_of("depressed")
    True
    >>> region_of("angry").contains(Emotion(-0.5, 0.4)), region_of("neutral")
    (True, RegionBox(valence=(-0.25, 0.25), arousal=(-0.25, 0.25)))

    Raises
    ------
    AffectError
        If the word is not known.
    """
    if word not in WORD_PLACES:
        raise AffectError(f"no emotion is called {word!r}; there are {', '.join(WORD_PLACES)}")
    valence, arousal = WORD_PLACES[word]
    if math.hypot(valence, arousal) < NEUTRAL_RADIUS:
        return RegionBox((-NEUTRAL_RADIUS, NEUTRAL_RADIUS), (-NEUTRAL_RADIUS, NEUTRAL_RADIUS))
    eighth = math.tau / len(SECTOR_WORDS)
    turns = round(math.atan2(arousal, valence) / eighth)
    return Sector(math.remainder(turns * eighth, math.tau), eighth, NEUTRAL_RADIUS)


def on_disc(valence: float, arousal: float) -> Emotion:
    """Return an emotion on the disc (eq. 4.1): one beyond its rim goes to the rim.

    >>> on_disc(3.0, 4.0)
    Emotion(valence=0.6, arousal=0.8, word=None, intensity=None)
    """
    beyond = max(1.0, math.hypot(valence, arousal))
    return Emotion(valence / beyond, arousal / beyond)


def _within(value: float, limits: tuple[float, float], margin: float) -> bool:
    return limits[0] - margin <= value <= limits[1] + margin
