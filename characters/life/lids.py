"""Which morphs close the eyes: there is no one name for them."""

import re
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

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
                found.setdefault(re.sub(r"[\W_]", "", form).lower(), number)
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
