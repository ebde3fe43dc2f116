"""How long a person rests between balance shifts, by what she feels."""

from dataclasses import dataclass

from cubeling.characters.errors import CharacterError


@dataclass(frozen=True)
class PauseLaw:
    """How activation shortens pauses: p_m + (α − e_a) β p_o (Egges 2006, eq. 4.2).

    Raises
    ------
    CharacterError
        If a number is out of its range.

    >>> PauseLaw().length(2.0, 8.0, 1.0), PauseLaw(beta=0.5).length(2.0, 8.0, 0.0)
    (2.0, 6.0)
    """

    alpha: float = 1.0
    """Activation at which a pause is as short as it gets, at least 1."""

    beta: float = 1.0
    """How much activation counts, at least 0: with 0, every pause is the shortest."""

    def __post_init__(self) -> None:
        if not (1.0 <= self.alpha <= 10.0 and 0.0 <= self.beta <= 10.0):
            raise CharacterError(
                f"idle: alpha {self.alpha:g} is to be 1 to 10, and beta {self.beta:g} 0 to 10"
            )

    def length(self, least: float, further: float, activation: float) -> float:
        """Return a pause [s]: `least` is p_m, `further` p_o or a share of it, 0 or more."""
        return least + (self.alpha - activation) * self.beta * further
