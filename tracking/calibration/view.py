"""The measurements in one still image of the calibration target."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from cubeling.tracking.geometry.arrays import Array, Indices


@dataclass(frozen=True)
class View:
    """Measurements in one image of a target that consists of flat, rigid plates.

    A cube has one plate per marker; a board is a single plate. Each row is one measurement along
    one direction: a point on an edge gives one row, across the edge; a corner gives two rows with
    perpendicular normals. All arrays have the same length N.
    """

    timestamp: float
    """Time of the frame [s]."""

    plates: Indices
    """Index of the plate of each point, (N,)."""

    points: Array
    """Nominal position of each point in the target frame, (N, 3) [m]."""

    pixels: Array
    """Measured position, (N, 2) [px]; accurate along the normal, approximate across it."""

    normals: Array
    """Unit vectors in the image along which the position was measured, (N, 2); for edges, from
    black to white."""

    bloom: Array
    """1 for rows that shift when white areas bloom over black ones (edges), else 0, (N,)."""

    lines: Indices
    """Index of the straight edge of each row, (N,). Rows of one edge have correlated errors."""


def join_views(timestamp: float, parts: Sequence[View]) -> View:
    """Combine the rows of views into one view."""
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


def view_of_corners(timestamp: float, plates: Indices, points: Array, pixels: Array) -> View:
    """Make a view of M corners; each becomes two rows, one for x and one for y.

    Plates (M,), points (M, 3) [m] and pixels (M, 2) [px] are as in `View`.
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
