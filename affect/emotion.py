"""An emotion: a point in the plane of valence and arousal, and the word for it."""

from dataclasses import dataclass

from cubeling.affect.hysteresis import label_at


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

    def __post_init__(self) -> None:
        for name, value in (("valence", self.valence), ("arousal", self.arousal)):
            if not -1.0 <= value <= 1.0:  # also refuses NaN
                raise ValueError(f"{name} must be from -1 to 1, not {value!r}")

    @property
    def label(self) -> str:
        """The word for it; without a chosen one "neutral", "happy" or "angry" by the valence."""
        return label_at(self.valence) if self.word is None else self.word


NEUTRAL = Emotion(0.0, 0.0, "neutral")
"""The origin of the plane."""
