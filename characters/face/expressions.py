"""Which morphs make which expression, and which move the mouth: there is no one name for them."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from characters.face.lids import plain
from characters.skeleton.pose import Array

EXPRESSIONS = ("happy", "angry", "sad", "surprised", "relaxed")
"""What a face can show, by VRM 1.0's names of its emotions."""

# VRM 1.0, VRM 0 and VRoid have a morph for each, under three names.
_WHOLE = {
    "happy": ("happy", "joy", "fclalljoy"),
    "angry": ("angry", "fclallangry"),
    "sad": ("sad", "sorrow", "fclallsorrow"),
    "surprised": ("surprised", "fclallsurprised"),
    "relaxed": ("relaxed", "fun", "fclallfun"),
}
# ARKit and Mixamo, Ready Player Me and Character Creator have parts of them, a pair or a single
# one each: how much of it there is in an expression.
_PARTS = {
    "happy": {"mouthsmile": 0.9, "cheeksquint": 0.5, "eyesquint": 0.3},
    "angry": {"browdown": 1.0, "nosesneer": 0.5, "mouthfrown": 0.5, "eyesquint": 0.3},
    "sad": {"browinnerup": 1.0, "mouthfrown": 0.8, "eyesquint": 0.2},
    "surprised": {"browinnerup": 0.8, "browouterup": 0.8, "eyewide": 0.8},
    "relaxed": {"mouthsmile": 0.35, "eyesquint": 0.6},
}
_SPEECH = ("aa", "ih", "ou", "ee", "oh", "a", "i", "u", "e", "o", "jawopen", "mouthopen",
           "mouthpucker", "mouthfunnel")  # fmt: skip


@dataclass(frozen=True)
class Expressions:
    """How the morphs of one character make faces."""

    numbers: NDArray[np.intp]
    """Numbers of the morphs that take part, (n,)."""

    weights: Array
    """How far each of them is on in each of `EXPRESSIONS`, (n, 5)."""

    speech: NDArray[np.intp]
    """Numbers of the morphs that move the mouth alone, as it does to speak, to kiss or to shout."""

    able: tuple[bool, ...]
    """Which of `EXPRESSIONS` there are."""

    @staticmethod
    def of(morphs: Sequence[str]) -> "Expressions":
        """Find them among the names of a character's morphs.

        >>> Expressions.of(["blink", "happy", "sad", "aa"]).able
        (True, False, True, False, False)
        """
        found: dict[str, int] = {}
        for number, name in enumerate(morphs):
            for form in (name, name.rpartition(".")[2]):
                found.setdefault(plain(form), number)
        weights = np.zeros((len(morphs), len(EXPRESSIONS)))
        for column, expression in enumerate(EXPRESSIONS):
            whole = next((n for n in _WHOLE[expression] if n in found), None)
            parts = {whole: 1.0} if whole is not None else _parts(expression, found)
            for name, weight in parts.items():
                weights[found[name], column] = weight
        numbers = np.flatnonzero(weights.any(axis=1))
        speech = [number for name, number in found.items() if name in _SPEECH]
        return Expressions(
            numbers,
            weights[numbers],
            np.array(sorted(set(speech) - set(numbers.tolist())), np.intp),
            tuple(bool(column.any()) for column in weights.T),
        )

    def __bool__(self) -> bool:
        """Whether there are any."""
        return any(self.able)


def _parts(expression: str, found: dict[str, int]) -> dict[str, float]:
    """Return the morphs that make an expression together; none where there is no mouth or brow."""
    parts = {
        stem + side: weight
        for stem, weight in _PARTS[expression].items()
        for side in ("", "left", "right", "l", "r")
        if stem + side in found
    }
    return parts if any(name.startswith(("mouth", "brow")) for name in parts) else {}
