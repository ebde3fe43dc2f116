"""What one still picture says: where points of the target lie, each across one line."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@dataclass(frozen=True)
class View:
    """Measurements in one picture of a target that is made of flat, rigid plates.

    A cube is six plates, one for each marker; a board is one. An edge tells a place across itself
    only, so it is one row; a corner is two rows with normals at right angles. All arrays have the
    same length N.
    """

    timestamp: float
    """Of the frame [s]."""

    plates: NDArray[np.intp]
    """Number of the plate that each point lies on, (N,)."""

    points: Array
    """Points of the target as it should be, in the target's frame, (N, 3) [m]."""

    pixels: Array
    """Where they were seen, (N, 2) [px]; true across the edge, and nearly so along it."""

    normals: Array
    """Unit vectors in the picture along which the place was measured, (N, 2): from black to white
    for edges."""

    bloom: Array
    """1 where a row moves when white grows over black (edges), 0 where it does not, (N,)."""

    lines: NDArray[np.intp]
    """Number of the straight line that a row belongs to, whose rows may err alike, (N,)."""

    @property
    def plate_numbers(self) -> tuple[int, ...]:
        """The plates seen, in order."""
        return tuple(int(number) for number in np.unique(self.plates))


def joined(timestamp: float, parts: list[View]) -> View:
    """Put what single plates say into one view of all of them."""
    lines, first = [], 0
    for part in parts:
        lines.append(part.lines + first)
        first += int(part.lines.max()) + 1
    return View(
        timestamp,
        np.concatenate([part.plates for part in parts]),
        np.concatenate([part.points for part in parts]),
        np.concatenate([part.pixels for part in parts]),
        np.concatenate([part.normals for part in parts]),
        np.concatenate([part.bloom for part in parts]),
        np.concatenate(lines),
    )


def of_corners(timestamp: float, plates: NDArray[np.intp], points: Array, pixels: Array) -> View:
    """Make a view of corners: each becomes two rows, one for x and one for y.

    Parameters
    ----------
    timestamp
        Of the frame [s].
    plates
        Number of the plate of each corner, (M,).
    points
        Where it is on the target, (M, 3) [m].
    pixels
        Where it was seen, (M, 2) [px].
    """
    count = len(points)
    return View(
        timestamp,
        np.repeat(np.asarray(plates, np.intp), 2),
        np.repeat(points, 2, axis=0),
        np.repeat(pixels, 2, axis=0),
        np.tile(np.eye(2), (count, 1)),
        np.zeros(2 * count),
        np.arange(2 * count),
    )
