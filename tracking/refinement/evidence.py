"""How much an image speaks for a pose, block by block, and whether it tells two poses apart."""

from dataclasses import dataclass

import numpy as np

from cubeling.tracking.geometry.arrays import Array

MIN_LEAD, MIN_DEVIATIONS, SURE_DEVIATIONS = 2.0, 1.645, 3.2
"""Lead in total evidence, and the same in its own standard deviations, from which on the better of
two poses is right; the third is enough alone. Measured on the lone markers of the dodecahedron, see
`make bench-photographs`."""

MAX_BEND = 11.3
"""A pose that bends paper more than this is not clearly right: 1 % of all paper is bent so."""


@dataclass(frozen=True, eq=False)
class Evidence:
    """How much likelier an image is with a cube at some pose than with even surfaces there."""

    blocks: Array
    """Twice the logarithm of that ratio, for each block of each face of the cube, (faces, blocks).
    0 where a face is out of view. What the bend of paper says against it are blocks, too."""

    bend: float = 0.0
    """Square of how far the paper of a lone face is bent at this pose, in its standard deviations
    (3 degrees of freedom)."""

    @property
    def total(self) -> float:
        """Sum over all blocks."""
        return float(self.blocks.sum())

    def clearly_exceeds(self, other: "Evidence") -> bool:
        """Whether it exceeds another by more than chance, by the scatter of all blocks.

        Print, folds and dirt make a few blocks speak for the wrong pose, however loudly
        (Vuong, 1989, "Likelihood ratio tests for model selection and non-nested hypotheses").
        """
        if self.bend > MAX_BEND:
            return False
        lead = self.blocks - other.blocks
        total, deviation = float(lead.sum()), float(np.sqrt(np.square(lead).sum()))
        least = max(MIN_LEAD, MIN_DEVIATIONS * deviation)
        return total > min(least, SURE_DEVIATIONS * deviation) > 0
