"""Which morphs close the eyes: there is no one name for them."""

import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from characters.mesh import Mesh
from characters.pose import Array

# Without capitals, marks and what stands before a dot. VRM, ARKit and Mixamo, Ready Player Me,
# VRoid, Character Creator and MikuMikuDance (whose names are Japanese) call it so.
_BOTH = ("blink", "eyeblink", "eyesblink", "eyesclosed", "eyeclosed", "eyesclose", "eyeclose",
         "closeeyes", "fcleyeclose", "まばたき")  # fmt: skip
_PAIRS = (*_BOTH, "blinkeye", "closeeye")
_SIDES = (("left", "right"), ("l", "r"))


@dataclass(frozen=True)
class Lids:
    """Morphs that close the eyes."""

    both: int | None
    """That of both eyes at once."""

    sides: NDArray[np.intp]
    """Those of the left and the right eye, two or none."""

    @staticmethod
    def of(morphs: Sequence[str]) -> "Lids":
        """Find them among the names of a character's morphs.

        >>> Lids.of(["jawOpen", "eyeBlinkLeft", "eyeBlinkRight"]).sides.tolist()
        [1, 2]
        """
        found: dict[str, int] = {}
        for number, name in enumerate(morphs):
            for form in (name, name.rpartition(".")[2]):
                found.setdefault(plain(form), number)
        both = next((found[name] for name in _BOTH if name in found), None)
        pairs = (
            (found[stem + left], found[stem + right])
            for stem in _PAIRS
            for left, right in _SIDES
            if stem + left in found and stem + right in found
        )
        return Lids(both, np.array(next(pairs, ()), np.intp))

    def __bool__(self) -> bool:
        """Whether there are any."""
        return self.both is not None or self.sides.size > 0

    def closed(self, weights: Array | None) -> float:
        """Return how far weights of morphs (morphs,) close the eyes by the lids' own morphs."""
        if weights is None or not self:
            return 0.0
        apart = float(weights[self.sides].max()) if self.sides.size else 0.0
        return apart if self.both is None else max(apart, float(weights[self.both]))

    def close(self, weights: Array, closed: float) -> None:
        """Close the eyes at least so far, 0…1, in weights of morphs (morphs,).

        A lid that is closed already, whether by the one morph or by the other, is not closed twice.
        """
        if closed <= 0.0:
            return
        if self.both is None:
            weights[self.sides] = np.maximum(weights[self.sides], closed)
            return
        apart = float(weights[self.sides].max()) if self.sides.size else 0.0
        weights[self.both] = max(float(weights[self.both]), min(closed, 1.0 - apart))

    def narrow(self, weights: Array, most: float) -> None:
        """Close the eyes at most so far, 0…1, in weights of morphs (morphs,)."""
        if self.both is not None:
            weights[self.both] = min(float(weights[self.both]), most)
        weights[self.sides] = np.minimum(weights[self.sides], most)


def plain(name: str) -> str:
    """Return a morph's name without capitals, blanks and marks.

    >>> plain("Eye Blink_L")
    'eyeblinkl'
    """
    return re.sub(r"[\W_]", "", name).lower()


def blinks_in(morphs: Sequence[str], meshes: Iterable[Mesh], lids: Lids) -> Array:
    """Return how much of a blink there is in each morph, (morphs,), from what they move.

    1 is a morph that closes the eyes as a blink does; below 0 are those that open them wider.
    What is added to a blink closes the lids too far by just this.
    """
    names = [morphs[number] for number in (lids.sides if lids.both is None else [lids.both])]
    along, whole = np.zeros(len(morphs)), 0.0
    for mesh in meshes:
        blink = np.zeros(mesh.positions.shape)
        for morph in mesh.morphs:
            if morph.name in names:
                blink[morph.vertices] += morph.shifts
        whole += float((blink * blink).sum())
        for morph in mesh.morphs:
            share = float((blink[morph.vertices] * morph.shifts).sum())
            along[morphs.index(morph.name)] += share
    return along / whole if whole > 0.0 else along
