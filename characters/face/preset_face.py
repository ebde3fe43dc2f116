"""What a face shows, in the presets that VRM gives names to, whatever morphs it has."""

from collections.abc import Mapping, Sequence
from functools import cache

import numpy as np

from cubeling.characters.face.expressions import EXPRESSIONS, ExpressionMorphs
from cubeling.characters.face.lids import Lids
from cubeling.characters.face.visemes.mouth_morphs import MouthMorphs
from cubeling.characters.skeleton.pose import Array

VOWELS = ("aa", "ih", "ou", "ee", "oh")
"""The shapes of the mouth, by their names in VRM 1.0."""

PRESETS = (*EXPRESSIONS, *VOWELS, "blink", "blinkLeft", "blinkRight")
"""The presets that are read, by their names in VRM 1.0."""

_NEUTRAL_LEVEL = 1  # of `MouthMorphs.weights`


class PresetFace:
    """Reads the presets from the weights of a character's morphs."""

    def __init__(self, morphs: Sequence[str]) -> None:
        self._lids = Lids.of(morphs)
        expressions, mouth = ExpressionMorphs.of(morphs), MouthMorphs.of(morphs)
        # What a face is made of is undone by least squares: presets overlap on faces of many parts.
        self._presets_from_morphs = np.zeros((len(morphs), len(EXPRESSIONS) + len(VOWELS)))
        if expressions:
            undone = np.linalg.pinv(expressions.weights).T
            self._presets_from_morphs[expressions.numbers, : len(EXPRESSIONS)] = undone
        for column, name in enumerate(VOWELS):  # of clips, on a face that speaks by others
            if name in morphs:
                self._presets_from_morphs[morphs.index(name), len(EXPRESSIONS) + column] = 1.0
        if mouth:
            undone = np.linalg.pinv(mouth.weights[_NEUTRAL_LEVEL])
            self._presets_from_morphs[mouth.numbers, len(EXPRESSIONS) :] = undone @ _vowels()

    def read(self, weights: Array | None) -> Mapping[str, float]:
        """Return the weight of each of `PRESETS`, 0…1, for those of the morphs, (morphs,)."""
        if weights is None:
            return dict.fromkeys(PRESETS, 0.0)
        shown = np.clip(weights @ self._presets_from_morphs, 0.0, 1.0).tolist()
        both = 0.0 if self._lids.both is None else float(weights[self._lids.both])
        sides = weights[self._lids.sides].tolist() or [0.0, 0.0]
        lids = np.clip([both, *sides], 0.0, 1.0).tolist()
        return dict(zip(PRESETS, [*shown, *lids], strict=True))


@cache
def _vowels() -> Array:
    """Return each shape of the mouth as a mix of `VOWELS`, (shapes, vowels)."""
    mouth = MouthMorphs.of(VOWELS)
    mix = np.zeros((mouth.weights.shape[1], len(VOWELS)))
    mix[:, mouth.numbers] = mouth.weights[_NEUTRAL_LEVEL]
    return mix
