"""Action units: which muscles of the face work, read off the morph weights of a character.

The facial action coding system (Ekman and Friesen, *Facial Action Coding System*, 1978) describes a
face by what its muscles do. `WRINKLE_UNITS` are those with wrinkles of their own in Huang, *3D
emotional rendering and animation models*, 2013, Table 4.1. Which units a whole expression has
follows EMFACS (Friesen and Ekman 1983): happy is 6 + 12, sad 1 + 4, angry 4, surprised 1 + 2. The
weights are ours.
"""

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cubeling.characters.face.lids import numbers_by_name
from cubeling.characters.model.face_maps import LAYER_NAMES, WRINKLE_LAYERS
from cubeling.characters.skeleton.pose import Array

WRINKLE_UNITS = tuple(WRINKLE_LAYERS)
"""Numbers of the action units that wrinkle the skin, in the order of `ActionUnits`."""

MORPH_UNITS: Mapping[str, Mapping[int, float]] = {
    # parts of a face, by ARKit's names
    "browinnerup": {1: 1.0},
    "browouterup": {2: 1.0},
    "browdown": {4: 1.0},
    "browlower": {4: 1.0},
    "cheeksquint": {6: 1.0},
    "eyesquint": {6: 0.4},
    "mouthupperup": {10: 1.0},
    "nosesneer": {10: 0.6},
    "mouthsmile": {12: 1.0},
    "mouthdimple": {12: 0.4},
    "mouthstretch": {20: 1.0},
    # whole faces, by VRM's names, and their mouths alone
    "happy": {6: 0.9, 12: 1.0},
    "angry": {4: 1.0, 10: 0.7},
    "sad": {1: 0.9, 4: 0.25},
    "surprised": {1: 0.9, 2: 0.9},
    "relaxed": {6: 0.5, 12: 0.6},
    "happymouth": {12: 1.0},
    "angrymouth": {10: 0.7},
    "relaxedmouth": {12: 0.6},
    # visemes whose lips are drawn apart, by the names of VRM and Oculus
    "ee": {20: 0.5},
    "ih": {20: 0.25},
    "visemei": {20: 0.4},
    "visemee": {20: 0.2},
    "visemess": {20: 0.25},
}
"""Intensity of action units at the full weight of a morph, by its name in lower case without blanks
and punctuation, and without its side. Names as AU12, au12_L or AU12Left are known besides."""

_SIDES = {"": (0, 1), "left": (0,), "right": (1,), "l": (0,), "r": (1,)}
_UNIT_NAME = re.compile(r"au0?(\d{1,2})")


@dataclass(frozen=True)
class ActionUnits:
    """How the morphs of one character move its action units."""

    numbers: NDArray[np.intp]
    """The morphs that take part, (n,)."""

    weights: Array
    """Intensity at their full weight, (n, units, sides): `WRINKLE_UNITS`; left, right."""

    @staticmethod
    def of(morphs: Sequence[str]) -> "ActionUnits":
        """Find them among the names of a character's morphs.

        >>> units = ActionUnits.of(["blink", "browInnerUp", "mouthSmileLeft"])
        >>> units.intensities(np.array([1.0, 0.5, 1.0]))[[0, 5]].tolist()
        [[0.5, 0.5], [1.0, 0.0]]
        """
        weights = np.zeros((len(morphs), len(WRINKLE_UNITS), 2))
        for name, number in numbers_by_name(morphs).items():
            for unit, side, weight in _parts(name):
                weights[number, WRINKLE_UNITS.index(unit), side] = weight
        numbers = np.flatnonzero(weights.any(axis=(1, 2)))
        return ActionUnits(numbers, weights[numbers])

    def __bool__(self) -> bool:
        return self.numbers.size > 0

    def intensities(self, morphs: Array | None) -> Array:
        """Return the intensity of each unit on each side, (units, sides), 0…1.

        `morphs` are the weights of all morphs, (morphs,); None for all zero. A weight below zero
        takes away what another morph shows.
        """
        if morphs is None:
            return np.zeros((len(WRINKLE_UNITS), 2))
        found = np.tensordot(np.asarray(morphs, float)[self.numbers], self.weights, 1)
        return np.asarray(np.clip(found, 0.0, 1.0))


def layer_intensities(units: Array) -> Array:
    """Return the intensity of each wrinkle layer, (12,), from those of `ActionUnits`, (units, 2).

    A layer for both sides has their mean.

    >>> raised = np.zeros((7, 2))
    >>> raised[:2] = 1.0  # AU1 + 2
    >>> np.flatnonzero(layer_intensities(raised)).tolist()
    [0, 1, 2]
    """
    found = np.zeros(len(LAYER_NAMES))
    for sides, layers in zip(units, WRINKLE_LAYERS.values(), strict=True):
        found[list(layers)] = sides if len(layers) == 2 else sides.mean()
    return found


def _parts(name: str) -> Iterator[tuple[int, int, float]]:
    """Yield unit, side and intensity of a morph, from its name without punctuation."""
    for ending, sides in _SIDES.items():
        stem = name.removesuffix(ending)
        if ending and stem == name:
            continue
        units = MORPH_UNITS.get(stem, {})
        named = _UNIT_NAME.fullmatch(stem)
        if named and int(named[1]) in WRINKLE_LAYERS:
            units = {int(named[1]): 1.0}
        for unit, weight in units.items():
            for side in sides:
                yield unit, side, weight
