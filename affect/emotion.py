"""An emotion: a point in the plane of valence and arousal, and the word for it."""

import math
from dataclasses import dataclass

from cubeling.affect.hysteresis import label_at

FULL_DISTANCE = 0.85
"""Distance from the origin of the plane from which on an emotion is shown completely."""

MIN_STRENGTH = 0.4
"""Least strength of an emotion that only its place tells: who is called angry looks angry."""


@dataclass(frozen=True)
class Emotion:
    """A point in the plane of valence and arousal (Russell 1980), and the word for it.

    It is one value from the scenario to the character's face, the virtual robot and the wire.

    >>> Emotion(0.8, 0.2).label
    'happy'
    >>> Emotion(0.8, 0.8, "excited").label
    'excited'
    """

    valence: float
    """From unpleasant, −1, to pleasant, 1."""

    arousal: float
    """From calm, −1, to excited, 1."""

    word: str | None = None
    """The word chosen for it, with hysteresis, from a label set; None where nobody has chosen."""

    intensity: float | None = None
    """How strongly the word is felt, 0…1; None where its place in the plane tells it."""

    def __post_init__(self) -> None:
        for name, value in (("valence", self.valence), ("arousal", self.arousal)):
            if not -1.0 <= value <= 1.0:  # also refuses NaN
                raise ValueError(f"{name} must be from -1 to 1, not {value!r}")
        if self.intensity is not None and not 0.0 <= self.intensity <= 1.0:
            raise ValueError(f"intensity must be from 0 to 1, not {self.intensity!r}")

    @property
    def strength(self) -> float:
        """How strongly a face shows its word, 0…1: its intensity, or else by its place.

        >>> Emotion(0.4, 0.2, "joy", 0.9).strength, Emotion(0.1, 0.0, "happy").strength
        (0.9, 0.4)
        """
        if self.intensity is not None:
            return self.intensity
        distance = math.hypot(self.valence, self.arousal)
        return min(max(distance / FULL_DISTANCE, MIN_STRENGTH), 1.0)

    @property
    def label(self) -> str:
        """The word for it; without a chosen one "neutral", "happy" or "angry" by the valence."""
        return label_at(self.valence) if self.word is None else self.word


NEUTRAL = Emotion(0.0, 0.0, "neutral")
"""The origin of the plane."""
