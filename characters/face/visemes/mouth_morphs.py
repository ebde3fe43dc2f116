"""From the shapes of the mouth to the morphs of a face, whoever made it.

Faces come in families with morphs of common names (`families.toml`). A face of several families
speaks by the richest alone, so that no movement is made twice. Jaw and lips are the two axes of
emphasis of Edwards et al., "JALI: an animator-centric viseme model", 2016: who mumbles lets the
jaw hang less than he lets the lips rest.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cache, cached_property
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cubeling.characters.face.lids import numbers_by_name
from cubeling.characters.face.visemes.sets import MOUTH_SHAPES, VOWEL_SHAPES
from cubeling.characters.skeleton.pose import Array
from cubeling.toml_file import bundled

LEVEL_GAINS: Mapping[str, tuple[float, float, float]] = {
    "jaw": (0.45, 0.75, 1.0),
    "lips": (0.65, 0.85, 1.0),
    "whole": (0.55, 0.80, 1.0),
    "rounded": (0.70, 0.92, 1.0),
}
"""How much of a vowel's shape its low, neutral and high versions have, by what a morph moves."""

OPENING: Mapping[str, float] = {
    "FF": 0.04, "TH": 0.2, "DD": 0.15, "kk": 0.25, "CH": 0.15, "SS": 0.06, "nn": 0.18,
    "RR": 0.2, "aa": 1.0, "E": 0.6, "I": 0.3, "O": 0.65, "U": 0.25,
}  # fmt: skip
"""How far each shape opens the jaw, 0…1; those left out do not."""


@dataclass(frozen=True)
class MouthMorphs:
    """How the morphs of one character speak."""

    family: str
    """Family of its face in `families.toml`; "" if no morph can speak."""

    numbers: NDArray[np.intp]
    """The morphs that take part, (n,)."""

    weights: Array
    """Their weights in each shape of each level, (levels, shapes, n)."""

    @staticmethod
    def of(morphs: Sequence[str]) -> "MouthMorphs":
        """Find them among the names of a character's morphs.

        >>> MouthMorphs.of(["Fcl_MTH_A", "Fcl_MTH_I", "Fcl_MTH_U", "Fcl_MTH_E"]).family
        'vowels'
        """
        found = numbers_by_name(morphs)
        for family in _families():
            parts = {
                part: list(_numbers(names, family, found))
                for part, names in family["names"].items()
            }
            if sum(map(bool, parts.values())) >= family["least"]:
                weights = _weights(family, parts, len(morphs))
                numbers = np.flatnonzero(weights.any(axis=(0, 1)))
                return MouthMorphs(family["name"], numbers, weights[:, :, numbers])
        return MouthMorphs("", np.zeros(0, np.intp), np.zeros((3, len(MOUTH_SHAPES), 0)))

    def __bool__(self) -> bool:
        return self.numbers.size > 0

    @cached_property
    def _flat(self) -> Array:
        return np.ascontiguousarray(self.weights.reshape(-1, self.numbers.size))

    def of_shapes(self, shapes: Array) -> Array:
        """Return the weights of the morphs, (n,), for those of the shapes, (levels, shapes)."""
        return np.asarray(shapes.ravel() @ self._flat)


def jaw_opening(shapes: Array) -> float:
    """Return how far shapes (levels, shapes) open the jaw, 0…1."""
    return float(np.sum(shapes * _JAW_OPENING))


def arkit_parts() -> Mapping[str, Mapping[str, float]]:
    """Return what each shape is made of, in weights of ARKit's morphs of the mouth, 0…1."""
    found: Mapping[str, Mapping[str, float]] = next(
        family["shapes"] for family in _families() if family["name"] == "arkit"
    )
    return found


def _level_gains(shape: str, moves: str) -> tuple[float, float, float]:
    return LEVEL_GAINS[moves] if shape in VOWEL_SHAPES else (1.0, 1.0, 1.0)


_JAW_OPENING = np.array(
    [
        [OPENING.get(s, 0.0) * _level_gains(s, "jaw")[level] for s in MOUTH_SHAPES]
        for level in range(3)
    ]
)


@cache
def _families() -> tuple[Mapping[str, Any], ...]:
    data = bundled(Path(__file__).with_name("families.toml"))
    return tuple(data["family"])


def _numbers(names: str, family: Mapping[str, Any], found: Mapping[str, int]) -> Iterator[int]:
    """Yield the morphs of a part of the mouth: one, or one for each side."""
    for name in names.split():
        if name in found:
            yield found[name]
            return
        for left, right in (("left", "right"), ("l", "r")) if family.get("sided") else ():
            if name + left in found and name + right in found:
                yield found[name + left]
                yield found[name + right]
                return


def _weights(family: Mapping[str, Any], parts: Mapping[str, Sequence[int]], count: int) -> Array:
    """Return the weights of all morphs in each shape of each level, (levels, shapes, morphs)."""
    weights = np.zeros((3, len(MOUTH_SHAPES), count))
    for shape, mix in family["shapes"].items():
        for part, weight in mix.items():
            if family.get("sided"):
                moves = "jaw" if part == "jawOpen" else "lips"
            else:
                moves = "rounded" if shape in ("O", "U") else "whole"
            for number in parts[part]:
                weights[:, MOUTH_SHAPES.index(shape), number] = weight * np.array(
                    _level_gains(shape, moves)
                )
    return weights
