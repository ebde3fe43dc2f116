"""The morphs that close the eyes, by any of their common names."""

import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from cubeling.characters.model.mesh import Mesh
from cubeling.characters.skeleton.pose import Array

# Normalised names of VRM, ARKit and Mixamo, Ready Player Me, VRoid, Character Creator and
# MikuMikuDance (whose names are Japanese).
_BOTH_EYES = ("blink", "eyeblink", "eyesblink", "eyesclosed", "eyeclosed", "eyesclose", "eyeclose",
              "closeeyes", "fcleyeclose", "まばたき")  # fmt: skip
_ONE_EYE_STEMS = (*_BOTH_EYES, "blinkeye", "closeeye")
_SIDE_SUFFIXES = (("left", "right"), ("l", "r"))

_MIN_CLOSED_QUANTILE = 0.1  # part of the lids that may be closed less than `blink_shares` says


@dataclass(frozen=True)
class Lids:
    """Morphs that close the eyes."""

    both: int | None
    """The morph of both eyes, or None."""

    sides: NDArray[np.intp]
    """The morphs of the left and the right eye: two or none."""

    @staticmethod
    def of(morphs: Sequence[str]) -> "Lids":
        """Find them among the names of a character's morphs.

        >>> Lids.of(["jawOpen", "eyeBlinkLeft", "eyeBlinkRight"]).sides.tolist()
        [1, 2]
        """
        found = numbers_by_name(morphs)
        both = next((found[name] for name in _BOTH_EYES if name in found), None)
        pairs = (
            (found[stem + left], found[stem + right])
            for stem in _ONE_EYE_STEMS
            for left, right in _SIDE_SUFFIXES
            if stem + left in found and stem + right in found
        )
        return Lids(both, np.array(next(pairs, ()), np.intp))

    def __bool__(self) -> bool:
        return self.both is not None or self.sides.size > 0

    def closure(self, weights: Array | None) -> float:
        """Return how far morph weights (morphs,) close the eyes by these morphs."""
        if weights is None or not self:
            return 0.0
        apart = float(weights[self.sides].max()) if self.sides.size else 0.0
        return apart if self.both is None else max(apart, float(weights[self.both]))

    def close(self, weights: Array, closed: float) -> None:
        """Close the eyes at least this far, 0…1, in morph weights (morphs,).

        A lid that is closed by one morph is not closed again by another.
        """
        if closed <= 0.0:
            return
        if self.both is None:
            weights[self.sides] = np.maximum(weights[self.sides], closed)
            return
        apart = float(weights[self.sides].max()) if self.sides.size else 0.0
        weights[self.both] = max(float(weights[self.both]), min(closed, 1.0 - apart))

    def limit(self, weights: Array, most: float) -> None:
        """Close the eyes at most this far, 0…1, in morph weights (morphs,)."""
        for number in self._all:
            if weights[number] > most:
                weights[number] = most

    @cached_property
    def _all(self) -> list[int]:
        sides: list[int] = self.sides.tolist()
        return sides if self.both is None else [self.both, *sides]


def numbers_by_name(morphs: Sequence[str]) -> dict[str, int]:
    """Return morph numbers by name and by its last part: lower case, no blanks or punctuation.

    >>> numbers_by_name(["Face.Eye Blink_L"])
    {'faceeyeblinkl': 0, 'eyeblinkl': 0}
    """
    found: dict[str, int] = {}
    for number, name in enumerate(morphs):
        for form in (name, name.rpartition(".")[2]):
            found.setdefault(re.sub(r"[\W_]", "", form).lower(), number)
    return found


def blink_shares(morphs: Sequence[str], meshes: Iterable[Mesh], lids: Lids) -> Array:
    """Return how far each morph closes the lids, (morphs,), 0…1, from the vertices that it moves.

    1 is a morph that closes the eyes as a blink does. The part of the lids that it closes least
    (`_MIN_CLOSED_QUANTILE`) counts, so that slanted lids leave no gap.
    """
    names = [morphs[number] for number in (lids.sides if lids.both is None else [lids.both])]
    ways, moved = [np.zeros((0, 3))], [np.zeros((len(morphs), 0, 3))]
    for mesh in meshes:
        blink = np.zeros(mesh.positions.shape)
        for morph in mesh.morphs:
            if morph.name in names:
                blink[morph.vertices] += morph.displacements
        lid = np.flatnonzero(blink.any(axis=1))
        # Lids are a small part of a mesh, and most morphs move none of it.
        place = np.full(len(blink), -1)
        place[lid] = np.arange(len(lid))
        displacements = np.zeros((len(morphs), len(lid), 3))
        for morph in mesh.morphs if lid.size else ():
            places = place[morph.vertices]
            on_lid = places >= 0
            displacements[morphs.index(morph.name), places[on_lid]] = morph.displacements[on_lid]
        ways.append(blink[lid])
        moved.append(displacements)
    way = np.concatenate(ways)
    if not len(way):
        return np.zeros(len(morphs))
    lengths = np.einsum("va,va->v", way, way)
    shares = np.einsum("mva,va->mv", np.concatenate(moved, axis=1), way) / lengths
    # Vertices that a blink moves far count for more than those at the corners of the eye.
    order = np.argsort(shares, axis=1)
    up_to = np.cumsum(lengths[order], axis=1) / lengths.sum()
    least = np.argmax(up_to >= _MIN_CLOSED_QUANTILE, axis=1)
    found = np.take_along_axis(shares, np.take_along_axis(order, least[:, None], 1), 1)[:, 0]
    return np.asarray(np.clip(found, 0.0, 1.0))
