"""Composition: what of an expression stays on a face that speaks.

Egges, *Real-time Animation of Interactive Virtual Humans*, 2006, section 5.3.1: speech has more
weight on the mouth, an expression on eyes and brows. The numbers are ours (specification S21):
the mouth belongs to the speech, and an expression keeps `MOUTH_SHARE` of its own there.
"""

from collections.abc import Sequence

from cubeling.characters.face.expressions import EXPRESSIONS, ExpressionMorphs
from cubeling.characters.face.lids import numbers_by_name

MOUTH_SHARE = 0.3
"""Share of an expression that stays on the mouth of a face that speaks."""

_CORNERS = {
    "happy": ("mouthsmile", 1.0),
    "angry": ("mouthfrown", 0.7),
    "sad": ("mouthfrown", 1.0),
    "relaxed": ("mouthsmile", 0.7),
}
"""What an expression does with the corners of closed lips, on faces with a morph for it."""

_UPPER_FACE = ("brow", "eye", "cheek", "nose")


class SpeakingExpression:
    """Takes expressions off the mouth of one character while it speaks.

    A morph of the whole face has either a second one with its mouth alone, named `happyMouth`,
    which is subtracted: the lips stay as closed as those of the speech, and the smile returns at
    their corners. Or it has none, as with VRM: then it is shown less as a whole.
    """

    def __init__(self, morphs: Sequence[str]) -> None:
        found, names = ExpressionMorphs.of(morphs), numbers_by_name(morphs)
        self._divided: list[tuple[int, int, int | None, float]] = []
        self._weakened: list[int] = []
        for row, number in zip(found.weights, found.numbers.tolist(), strict=True):
            expression = EXPRESSIONS[int(row.argmax())]
            name = morphs[number].rpartition(".")[2].lower()
            mouth = names.get(f"{expression}mouth")
            if mouth is not None and name == expression:
                corners, share = _CORNERS.get(expression, ("", 0.0))
                self._divided.append((number, mouth, names.get(corners), share * MOUTH_SHARE))
            elif not name.startswith(_UPPER_FACE):
                self._weakened.append(number)

    def apply(self, weights: list[float], presence: float) -> None:
        """Change the weights of all morphs in place for a face that speaks so much, 0…1."""
        for number, mouth, corners, share in self._divided:
            shown = presence * weights[number]
            weights[mouth] -= shown
            if corners is not None:
                weights[corners] += share * shown
        for number in self._weakened:
            weights[number] *= 1.0 - (1.0 - MOUTH_SHARE) * presence
