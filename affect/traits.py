"""The five traits of a personality, and what is computed of them."""

from dataclasses import astuple, dataclass
from typing import NamedTuple

from cubeling.affect.emotion import Emotion


class TraitRow(NamedTuple):
    """How strongly each trait counts for one quantity."""

    openness: float
    conscientiousness: float
    extraversion: float
    agreeableness: float
    neuroticism: float

    def response(self, ocean: "Ocean") -> float:
        """Return a row of P₀ p (eq. 5.8), 0…1.

        >>> THESIS_POSITIVE_ROW.response(Ocean(0.8, 0.1, 0.7, 0.5, 0.05))  # the thesis' example
        0.62
        """
        traits: tuple[float, ...] = astuple(ocean)
        product = sum(row * trait for row, trait in zip(self, traits, strict=True))
        return round(min(max(product, 0.0), 1.0), 9)


THESIS_POSITIVE_ROW = TraitRow(0.15, 0.0, 0.45, 0.40, -0.30)
"""Row of P₀ for pleasant emotions (specification S17; the thesis has no numbers)."""

THESIS_NEGATIVE_ROW = TraitRow(0.10, 0.10, 0.0, 0.10, 0.70)
"""Row of P₀ for unpleasant ones."""

MEHRABIAN_ROWS = (
    TraitRow(0.0, 0.0, 0.21, 0.59, -0.19),
    TraitRow(0.15, 0.0, 0.0, 0.30, 0.57),
    TraitRow(0.25, 0.17, 0.60, -0.32, 0.0),
)
"""Pleasure, arousal and dominance of a temperament by its centred traits (Mehrabian 1996).

His fourth trait is emotional stability, neuroticism turned round: hence the signs in its column.
"""


@dataclass(frozen=True)
class Ocean:
    """The five traits of a personality, each 0…1 (specification S17: its example has all five)."""

    openness: float = 0.5
    """Imaginative rather than unimaginative."""

    conscientiousness: float = 0.5
    """Organised rather than careless."""

    extraversion: float = 0.5
    """Outgoing rather than reserved."""

    agreeableness: float = 0.5
    """Kind rather than hostile."""

    neuroticism: float = 0.5
    """Moody and nervous rather than even-tempered."""

    @property
    def responses(self) -> tuple[float, float]:
        """Strength of the response to pleasant and to unpleasant impulses, (u₊, u₋), each 0…1."""
        return THESIS_POSITIVE_ROW.response(self), THESIS_NEGATIVE_ROW.response(self)

    @property
    def temperament(self) -> Emotion:
        """The emotion at rest: pleasure and arousal by Mehrabian (1996), scaled by a third.

        The factor is ours: the label at rest stays "neutral".
        """
        centred = [2.0 * trait - 1.0 for trait in astuple(self)]
        pleasure, arousal, _ = (
            sum(share * trait for share, trait in zip(row, centred, strict=True))
            for row in MEHRABIAN_ROWS
        )
        return Emotion(pleasure / 3.0, arousal / 3.0)
