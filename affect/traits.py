"""Impulses in the plane of valence and arousal, and the five traits that scale them."""

from dataclasses import astuple, dataclass

from cubeling.affect.emotion import Emotion


@dataclass(frozen=True)
class AffectImpulse:
    """A displacement in the plane: the rate of an action [1/s], or the effect of an event."""

    valence: float = 0.0
    """Towards pleasant; negative towards unpleasant."""

    arousal: float = 0.0
    """Towards excited; negative towards calm."""

    def times(self, factor: float) -> "AffectImpulse":
        """Return the impulse scaled by a factor."""
        return AffectImpulse(self.valence * factor, self.arousal * factor)


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
        """Strength of the response to pleasant and to unpleasant impulses, (u₊, u₋), each 0…1.

        u = P₀ p (Egges, as in specification S17, which gives the rows of P₀).

        >>> Ocean(0.8, 0.1, 0.7, 0.5, 0.05).responses  # the thesis' example
        (0.62, 0.175)
        """
        o, c, e, a, n = astuple(self)
        good = 0.15 * o + 0.45 * e + 0.40 * a - 0.30 * n
        bad = 0.10 * o + 0.10 * c + 0.10 * a + 0.70 * n
        return round(min(max(good, 0.0), 1.0), 9), round(min(max(bad, 0.0), 1.0), 9)

    @property
    def temperament(self) -> Emotion:
        """The emotion at rest: pleasure and arousal by Mehrabian (1996), scaled by a third.

        The factor is ours: the label at rest stays "neutral".
        """
        o, e, a = (
            2.0 * trait - 1.0 for trait in (self.openness, self.extraversion, self.agreeableness)
        )
        stable = 1.0 - 2.0 * self.neuroticism
        pleasure = 0.21 * e + 0.59 * a + 0.19 * stable
        arousal = 0.15 * o + 0.30 * a - 0.57 * stable
        return Emotion(pleasure / 3.0, arousal / 3.0)
