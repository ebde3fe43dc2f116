"""From the pinhole matrix of OpenCV to the clip space of OpenGL, exactly."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from characters.rendering.scene import Rectangle

Array = NDArray[np.float64]

NEAR, FAR = 0.02, 20.0
"""Depths between which things are drawn [m]: from a hand before the lens to the end of a room."""


SLACK = 0.02
"""Share of its size by which a part is larger than its points: a few stand for many."""

FIXED = 12_000
"""Pixels that software rendering draws in the time that one more part costs."""


def clip_from_camera(matrix: Array, part: Rectangle) -> Array:
    """Return the projection that draws one part of a picture into a viewport of the same size.

    OpenCV puts the centre of the top-left pixel at (0, 0), OpenGL the corner of a viewport; hence
    the halves. Row 0 of the viewport is the part's top row: what is read back needs no flip.

    Parameters
    ----------
    matrix
        Pinhole matrix of the whole picture, (3, 3) [px].
    part
        The part to draw.

    Returns
    -------
    NDArray
        (4, 4), for points in the camera frame (x right, y down, z forward).

    >>> k = np.array([[100., 0, 31.5], [0, 100, 23.5], [0, 0, 1]])
    >>> clip = clip_from_camera(k, Rectangle(0, 0, 64, 48)) @ [0, 0, 1, 1]
    >>> clip[:2].tolist(), float(clip[3])
    ([0.0, 0.0], 1.0)
    """
    (fx, skew, cx), (_, fy, cy) = matrix[0], matrix[1]
    across, down = 2.0 / part.width, 2.0 / part.height
    depth = (FAR + NEAR) / (FAR - NEAR)
    return np.array(
        [
            [across * fx, across * skew, across * (cx + 0.5 - part.x) - 1.0, 0.0],
            [0.0, down * fy, down * (cy + 0.5 - part.y) - 1.0, 0.0],
            [0.0, 0.0, depth, -2.0 * FAR * NEAR / (FAR - NEAR)],
            [0.0, 0.0, 1.0, 0.0],
        ]
    )


def part_that_shows(
    points: Array, matrix: Array, camera_from_table: Array, size: tuple[int, int], margin: int = 3
) -> Rectangle | None:
    """Return the part of a picture that holds all of some points, and a little more.

    Parameters
    ----------
    points
        In the table frame, (n, 3) [m].
    matrix, camera_from_table
        The camera: (3, 3) [px] and (4, 4) [m].
    size
        Of the picture, (width, height) [px].
    margin
        Pixels to add on each side.

    Returns
    -------
    Rectangle or None
        The whole picture where a point is behind the camera; None where no part of it shows any.
    """
    seen = points @ camera_from_table[:3, :3].T + camera_from_table[:3, 3]
    behind = seen[:, 2] < NEAR
    if not len(points) or behind.all():
        return None
    width, height = size
    if behind.any():
        return Rectangle(0, 0, width, height)
    pixels = (seen / seen[:, 2:]) @ matrix[:2].T
    low, high = pixels.min(axis=0), pixels.max(axis=0)
    rim = margin + SLACK * (high - low)
    low = np.clip(np.floor(low - rim), 0, size).astype(int)
    high = np.clip(np.ceil(high + rim) + 1, 0, size).astype(int)
    if (high <= low).any():
        return None
    return Rectangle(int(low[0]), int(low[1]), int(high[0] - low[0]), int(high[1] - low[1]))


def merged(parts: Sequence[Rectangle]) -> list[Rectangle]:
    """Return fewer parts that hold the same: two become one where that costs less than it saves.

    A part has a fixed cost, about that of `FIXED` pixels.
    """
    kept: list[Rectangle] = []
    for part in parts:
        while kept:
            both = part.joined(kept[-1])
            if both.area > part.area + kept[-1].area + FIXED:
                break
            part, _ = both, kept.pop()
        kept.append(part)
    return kept


def is_rigid(transform: Array | None) -> bool:
    """Whether a transform is there, finite, and not flattened: scaled at most, never singular."""
    if transform is None or np.shape(transform) != (4, 4) or not np.isfinite(transform).all():
        return False
    axes = np.asarray(transform, float)[:3, :3]
    # Against their lengths: what was made in millimetres comes to the table at a ten-thousandth.
    space = float(np.prod(np.linalg.norm(axes, axis=0)))
    return bool(abs(np.linalg.det(axes)) > 1e-6 * space)


def is_pinhole(matrix: Array) -> bool:
    """Whether a matrix is that of a camera: (3, 3), finite, with two positive focal lengths."""
    if np.shape(matrix) != (3, 3) or not np.isfinite(matrix).all():
        return False
    return bool(matrix[0, 0] > 0.0 and matrix[1, 1] > 0.0)
