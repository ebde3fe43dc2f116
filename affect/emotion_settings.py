"""How the 24 emotions of a personality respond and fade: P₀ and C_e of the thesis, and a mood."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import Literal, get_args

from cubeling.affect.errors import AffectError
from cubeling.affect.occ import ALMA_MATRIX, OCC_PLACES, TWO_ROWS, InfluenceMatrix, check_words
from cubeling.affect.traits import Ocean, TraitRow
from cubeling.toml_file import TomlTable

MatrixName = Literal["alma", "thesis"]
"""A matrix that a file may name."""

MATRICES: Mapping[MatrixName, InfluenceMatrix] = MappingProxyType(
    {"alma": ALMA_MATRIX, "thesis": TWO_ROWS}
)
"""P₀ by its name."""

DecayLaw = Literal["linear", "exponential"]
"""How an intensity fades: by the same amount each second, or by the same share."""

MAX_ROW = 5.0
"""Largest entry of P₀ in a file."""


@dataclass(frozen=True)
class MoodLayer:
    """A mood under the emotions, which the thesis does not have.

    It is a number from bad, −1, to good, 1. What is felt moves it; it lasts longer, and colours
    what is felt next. The numbers are those of FAtiMA's toolkit (Mascarenhas et al. 2022).
    """

    share: float = 0.3
    """How far an emotion of full strength moves the mood."""

    half_life_s: float = 60.0
    """Time in which it comes half the way back to zero [s]."""

    colour: float = 0.3
    """How much the best mood strengthens what is pleasant, weakens the rest, and shows by itself as
    valence."""


@dataclass(frozen=True)
class EmotionSettings:
    """What a personality with 24 emotions has beside its gains and events."""

    matrix: InfluenceMatrix = field(default_factory=lambda: ALMA_MATRIX)
    """P₀: how strongly each trait lets each emotion respond (eq. 5.8)."""

    decay: DecayLaw = "linear"
    """The law by which intensities fade: linear in the thesis (eq. 5.11)."""

    decay_per_s: float = 0.02
    """C_e: what an intensity loses [1/s], if linear (specification S17; the thesis has none)."""

    half_life_s: float = 15.0
    """Time in which half of an intensity is gone [s], if exponential."""

    mood: MoodLayer | None = None
    """A mood under the emotions; None for none, as in the thesis."""

    def responses(self, ocean: Ocean | None) -> dict[str, float]:
        """Return how strongly each emotion responds, u = P₀ p, 0…1; 1 without traits."""
        if ocean is None:
            return dict.fromkeys(OCC_PLACES, 1.0)
        return {word: self.matrix[word].response(ocean) for word in OCC_PLACES}


def read_emotion_settings(table: TomlTable) -> EmotionSettings:
    """Return the settings in the table `emotions` of a personality's file.

    Raises AffectError for a wrong value.
    """
    table.only("matrix", "decay", "decay_per_s", "half_life_s", "mood", "rows")
    usual = EmotionSettings()
    rows = table.table("rows")
    try:
        check_words(dict.fromkeys(rows))
    except AffectError as error:
        raise AffectError(f"{table.source}: {table.at('rows')}: {error}") from None
    given = {word: TraitRow(*rows.numbers(word, 5, -MAX_ROW, MAX_ROW)) for word in rows}
    name: MatrixName = table.choice("matrix", get_args(MatrixName), "alma")  # type: ignore[assignment]
    law: DecayLaw = table.choice("decay", get_args(DecayLaw), usual.decay)  # type: ignore[assignment]
    return EmotionSettings(
        MappingProxyType({**MATRICES[name], **given}),
        law,
        table.number("decay_per_s", 0.0, 10.0, usual.decay_per_s),
        table.number("half_life_s", 0.05, default=usual.half_life_s),
        _mood(table.table("mood", *vars(MoodLayer()))) if "mood" in table else None,
    )


def _mood(table: TomlTable) -> MoodLayer:
    usual = MoodLayer()
    return MoodLayer(
        table.number("share", 0.0, 1.0, usual.share),
        table.number("half_life_s", 0.05, default=usual.half_life_s),
        table.number("colour", 0.0, 1.0, usual.colour),
    )
