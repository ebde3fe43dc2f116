"""Which kinds of views a calibration still needs, and which one to ask for next.

Without tilt, focal length and distance cannot be told apart: 20 views tilted by 12° leave the focal
length uncertain by 2.8 %, tilted by 35° by 0.4 %. Lens distortion is largest in the corners of the
image, so the target must be shown there, and near views carry more information than far ones.
"""

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

MIN_TILT_RAD = np.deg2rad(18)
"""Smallest tilt of a plate that counts as tilted."""

MAX_TILT_DIRECTION_ERROR_RAD = np.deg2rad(55)
"""Largest angle between a plate's tilt and a direction for the tilt to count in that direction."""

MIN_NEAR_SIZE, MAX_FAR_SIZE = 0.20, 0.15
"""Side of a marker that counts as near or far [image heights]; twice as much for a board."""

CORNER_SHARE = 0.38
"""A target is in a corner if its centre is in this outer share of the width and of the height."""

TILT_DIRECTIONS = {
    "tilt up": np.array([0.0, -1.0]),
    "tilt down": np.array([0.0, 1.0]),
    "tilt left": np.array([-1.0, 0.0]),
    "tilt right": np.array([1.0, 0.0]),
}
"""Where a tilted plate faces in the image: x right, y down."""

CORNER_KINDS = ("top left", "top right", "bottom left", "bottom right")

VIEWS_NEEDED = {
    **dict.fromkeys(TILT_DIRECTIONS, 3),
    **dict.fromkeys(CORNER_KINDS, 2),
    "middle": 2,
    "near": 4,
    "far": 2,
}
"""Number of views needed of each kind."""

VIEWS_NEEDED_PER_PLATE = 3
"""Number of views needed of each plate together with another one."""

REQUEST_ORDER = (
    "tilt up", "tilt left", "tilt down", "tilt right", "near", *CORNER_KINDS, "middle", "far"
)  # fmt: skip
"""Kinds in the order in which they are asked for."""


@dataclass(frozen=True)
class ViewSample:
    """How the target appears in one image."""

    centre: tuple[float, float]
    """Centre of the target in the image, x and y from the top left, each 0…1."""

    size: float
    """Mean side of the largest plate [image heights]."""

    tilt: tuple[float, float]
    """Tilt of the plate that faces the camera most directly: angle between its normal and the line
    of sight, split into right and down in the image [rad]."""

    plates: tuple[int, ...]
    """Indices of the visible plates."""


class ViewCoverage:
    """Counts views by kind and says which kind is still missing.

    Parameters
    ----------
    plates
        Names of the target's plates; with a single plate no side views are needed.
    """

    def __init__(self, plates: Sequence[str]) -> None:
        self._plates = tuple(plates)
        self.needed = dict(VIEWS_NEEDED)
        """Number of views needed of each kind."""
        if len(plates) > 1:
            self.needed |= {f"side {name}": VIEWS_NEEDED_PER_PLATE for name in plates}
        self.counts: Counter[str] = Counter()
        """Number of views of each kind so far."""

    def kinds_of(self, sample: ViewSample) -> set[str]:
        """Return the kinds of view that a sample counts for."""
        x, y = sample.centre
        angle = np.linalg.norm(sample.tilt)
        kinds = {
            name
            for name, direction in TILT_DIRECTIONS.items()
            if angle >= MIN_TILT_RAD
            and np.dot(sample.tilt, direction) >= np.cos(MAX_TILT_DIRECTION_ERROR_RAD) * angle
        }
        across = "left" if x < CORNER_SHARE else "right" if x > 1 - CORNER_SHARE else ""
        down = "top" if y < CORNER_SHARE else "bottom" if y > 1 - CORNER_SHARE else ""
        if across and down:
            kinds.add(f"{down} {across}")
        if not across and not down:
            kinds.add("middle")
        scale = 2.0 if len(self._plates) == 1 else 1.0
        if sample.size >= MIN_NEAR_SIZE * scale:
            kinds.add("near")
        if sample.size <= MAX_FAR_SIZE * scale:
            kinds.add("far")
        if len(sample.plates) > 1:
            kinds |= {f"side {self._plates[number]}" for number in sample.plates}
        return kinds

    def add(self, sample: ViewSample) -> None:
        """Count a view for every kind that it belongs to."""
        self.counts.update(self.kinds_of(sample))

    def progress_of(self, kind: str) -> float:
        """Return how complete one kind is, 0…1."""
        return min(1.0, self.counts[kind] / self.needed[kind])

    @property
    def progress(self) -> float:
        """How complete the views are in total, 0…1."""
        return float(np.mean([self.progress_of(kind) for kind in self.needed]))

    @property
    def complete(self) -> bool:
        """Whether there are enough views of every kind."""
        return not self.next_kind()

    def next_kind(self) -> str:
        """Return the kind to ask for now; "" if the views are complete.

        The answer stays the same until that kind is complete, so the requests do not alternate.
        """
        missing = (kind for kind in self.needed if self.progress_of(kind) < 1)
        return min(missing, key=[*REQUEST_ORDER, *self.needed].index, default="")

    def require_more(self) -> None:
        """Require two more near views and two more of each tilt: the camera is not determined."""
        for kind in (*TILT_DIRECTIONS, "near"):
            self.needed[kind] = max(self.needed[kind], self.counts[kind]) + 2
