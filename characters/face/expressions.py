"""The morphs of expressions and of the mouth, by any of their common names."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cubeling.characters.face.lids import numbers_by_name
from cubeling.characters.skeleton.pose import Array

EXPRESSIONS = ("happy", "angry", "sad", "surprised", "relaxed")
"""The expressions, by the names that VRM 1.0 gives to those of emotion."""

# VRM 1.0, VRM 0 and VRoid have one morph for each, under different names.
_WHOLE_FACE_MORPHS = {
    "happy": ("happy", "joy", "fclalljoy"),
    "angry": ("angry", "fclallangry"),
    "sad": ("sad", "sorrow", "fclallsorrow"),
    "surprised": ("surprised", "fclallsurprised"),
    "relaxed": ("relaxed", "fun", "fclallfun"),
}
# ARKit and Mixamo, Ready Player Me and Character Creator have morphs of parts of the face, a pair
# or a single one each: their weights in each expression.
_FACE_PART_WEIGHTS = {
    "happy": {"mouthsmile": 0.9, "cheeksquint": 0.5, "eyesquint": 0.3},
    "angry": {"browdown": 1.0, "nosesneer": 0.5, "mouthfrown": 0.5, "eyesquint": 0.3},
    "sad": {"browinnerup": 1.0, "mouthfrown": 0.8, "eyesquint": 0.2},
    "surprised": {"browinnerup": 0.8, "browouterup": 0.8, "eyewide": 0.8},
    "relaxed": {"mouthsmile": 0.35, "eyesquint": 0.6},
}
_SPEECH_MORPHS = ("aa", "ih", "ou", "ee", "oh", "a", "i", "u", "e", "o", "jawopen", "mouthopen",
                  "mouthpucker", "mouthfunnel")  # fmt: skip


@dataclass(frozen=True)
class ExpressionMorphs:
    """How the morphs of one character make expressions."""

    numbers: NDArray[np.intp]
    """The morphs that take part, (n,)."""

    weights: Array
    """Their weights in each of `EXPRESSIONS`, (n, 5)."""

    speech: NDArray[np.intp]
    """The morphs that move the mouth alone, to speak, kiss or shout."""

    able: tuple[bool, ...]
    """Which of `EXPRESSIONS` the character has."""

    @staticmethod
    def of(morphs: Sequence[str]) -> "ExpressionMorphs":
        """Find them among the names of a character's morphs.

        >>> ExpressionMorphs.of(["blink", "happy", "sad", "aa"]).able
        (True, False, True, False, False)
        """
        found = numbers_by_name(morphs)
        weights = np.zeros((len(morphs), len(EXPRESSIONS)))
        for column, expression in enumerate(EXPRESSIONS):
            whole = next((n for n in _WHOLE_FACE_MORPHS[expression] if n in found), None)
            parts = {whole: 1.0} if whole is not None else _parts(expression, found)
            for name, weight in parts.items():
                weights[found[name], column] = weight
        numbers = np.flatnonzero(weights.any(axis=1))
        speech = [number for name, number in found.items() if name in _SPEECH_MORPHS]
        return ExpressionMorphs(
            numbers,
            weights[numbers],
            np.array(sorted(set(speech) - set(numbers.tolist())), np.intp),
            tuple(bool(column.any()) for column in weights.T),
        )

    def __bool__(self) -> bool:
        return any(self.able)


def _parts(expression: str, found: dict[str, int]) -> dict[str, float]:
    """Return the morphs that make an expression together; none without a mouth or a brow."""
    parts = {
        stem + side: weight
        for stem, weight in _FACE_PART_WEIGHTS[expression].items()
        for side in ("", "left", "right", "l", "r")
        if stem + side in found
    }
    return parts if any(name.startswith(("mouth", "brow")) for name in parts) else {}
