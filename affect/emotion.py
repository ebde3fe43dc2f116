"""What a robot feels, as numbers and as words."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Emotion:
    """A point in the plane of valence and arousal (Russell 1980).

    >>> Emotion(0.8, 0.2).label
    'happy'
    >>> Emotion(-0.8, 0.2).label
    'angry'
    """

    valence: float
    """From unpleasant, −1, to pleasant, 1."""

    arousal: float
    """From calm, −1, to excited, 1."""

    def __post_init__(self) -> None:
        for name, value in (("valence", self.valence), ("arousal", self.arousal)):
            if not -1.0 <= value <= 1.0:  # also refuses NaN
                raise ValueError(f"{name} must be from -1 to 1, not {value!r}")

    @property
    def label(self) -> str:
        """The word for it, without memory: "neutral", "happy" or "angry".

        `MoodLine` gives the same words with hysteresis.
        """
        if self.valence > HAPPY_ABOVE:
            return "happy"
        return "angry" if self.valence < ANGRY_BELOW else "neutral"


HAPPY_ABOVE = 0.33
"""Valence above which the mood is called happy (Fernández-Baena 2015, section 5.3, names the moods;
the value is the specification's)."""

ANGRY_BELOW = -0.33
"""Valence below which the mood is called angry."""
