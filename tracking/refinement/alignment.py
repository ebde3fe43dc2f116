"""What aligning a blurred picture tells: pose, motion, and what camera took it."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Alignment:
    """A pose and a motion that explain a blurred picture."""

    camera_from_cube: Array
    """Pose of the cube in mid-exposure, (4, 4) [m]."""

    sweep: Array
    """Shift-turn of the cube while the shutter was open, (6,)."""

    covariance: Array
    """Of a shift-turn of the pose and then of the sweep, (12, 12)."""

    told: tuple[Array, Array]
    """What the picture alone says of the sweep: information times sweep, (6,), and information,
    (6, 6)."""

    likeness: float
    """Correlation of the drawn and the seen picture, −1…1, over all samples that were in view."""

    shares: dict[str, float]
    """The same for each face in view."""

    residual: float
    """Standard deviation of the samples that fit, as a share of the contrast."""

    bend: float
    """By how much mixtures of black and white are brighter than they should be, see `Response`."""

    black: float
    """What black is beside white, in the face whose contrast is greatest."""

    @property
    def weakest(self) -> float:
        """The least of these correlations."""
        return min(self.likeness, *self.shares.values())
