"""Where real cubes are in the picture, and what they hide."""

import math
from collections.abc import Sequence
from itertools import pairwise

import cv2
import numpy as np
from numpy.typing import NDArray

from cubeling.characters.rendering.projection import (
    NEAR_M,
    Rectangle,
    bounding_rectangle,
    is_invertible,
    project,
)
from cubeling.characters.rendering.scene import Box
from cubeling.characters.skeleton.pose import Array

_FACE = np.array([(-1, -1, 1), (1, -1, 1), (1, 1, 1), (-1, -1, 1), (1, 1, 1), (-1, 1, 1)]) / 2
UNIT_CUBE = np.concatenate([s * np.roll(_FACE, axis, axis=1) for axis in range(3) for s in (1, -1)])
"""Corners of the twelve triangles of a cube, (36, 3)."""

_EDGE_ENDS = np.array([(a, a | b) for a in range(8) for b in (1, 2, 4) if not a & b])
_CORNERS = (np.arange(8)[:, None] >> np.arange(3) & 1) - 0.5
CUBE_EDGES = _CORNERS[_EDGE_ENDS]
"""Both ends of its twelve edges, (12, 2, 3)."""


def hidden_by_cube(box: Box, matrix: Array, area: Rectangle) -> NDArray[np.uint8]:
    """Return the share of each pixel of an area that a box hides, (height, width) 0…255.

    A side of its outline gives the distance inside of it [px]; the transition is one pixel wide.
    """
    x = np.arange(area.x, area.x + area.width, dtype=np.float32)
    y = np.arange(area.y, area.y + area.height, dtype=np.float32)[:, None]
    inside = np.ones((area.height, area.width), np.float32)
    from_line = np.empty_like(inside)
    for a, b, c in np.array(_outline(box, matrix), np.float32):
        np.add(a * x, b * y + (c + np.float32(0.5)), out=from_line)
        np.minimum(inside, from_line, out=inside)
    return np.asarray(cv2.convertScaleAbs(np.maximum(inside, 0.0), alpha=255.0), np.uint8)


def camera_from_unit_cube(box: Box) -> Array:
    """Return the pose of a box scaled by its edge, (4, 4): in its frame, the edge is 1 long."""
    return np.asarray(box.camera_from_box @ np.diag([box.edge, box.edge, box.edge, 1.0]))


def unit_cube_from_table(box: Box, camera_from_table: Array) -> Array:
    """Return the table in the frame of a box whose edge is 1 long, (4, 4)."""
    return np.asarray(np.linalg.inv(camera_from_unit_cube(box)) @ camera_from_table)


def corners_of(box: Box, camera_from_table: Array) -> Array:
    """Return the eight corners of a box in the table frame, (8, 3) [m]."""
    table_from_box = np.linalg.inv(camera_from_table) @ box.camera_from_box
    return np.asarray(box.edge * _CORNERS @ table_from_box[:3, :3].T + table_from_box[:3, 3])


def visible_cubes(
    boxes: Sequence[Box], matrix: Array, size: tuple[int, int]
) -> tuple[tuple[Box, Rectangle], ...]:
    """Return the boxes in a picture of a `size` (width, height) [px], and where they are in it."""
    visible = []
    for box in boxes:
        if is_usable(box):
            area = bounding_rectangle(box.edge * UNIT_CUBE, matrix, box.camera_from_box, size)
            if area is not None:
                visible.append((box, area))
    return tuple(visible)


def is_usable(box: Box) -> bool:
    """Return whether a box has a pose and a size."""
    return is_invertible(box.camera_from_box) and bool(np.isfinite(box.edge) and box.edge > 0.0)


def _outline(box: Box, matrix: Array) -> list[tuple[float, float, float]]:
    """Return the lines a·x + b·y + c = 0 around a box in the picture, positive inside [px]."""
    pose = np.asarray(box.camera_from_box, float)
    visible = box.edge * _CORNERS @ pose[:3, :3].T + pose[:3, 3]
    if visible[:, 2].min() < NEAR_M:
        visible = _clip(box.edge * CUBE_EDGES @ pose[:3, :3].T + pose[:3, 3])
    # Its corners come in one sense of rotation, so that the inside is on one side of all lines.
    hull = cv2.convexHull(project(visible, matrix).astype(np.float32), clockwise=False)[:, 0]
    lines = []
    for (x, y), (to_x, to_y) in pairwise([*hull.tolist(), hull[0].tolist()]):
        length = max(math.hypot(to_x - x, to_y - y), 1e-9)
        a, b = (y - to_y) / length, (to_x - x) / length
        lines.append((a, b, -(a * x + b * y)))
    return lines


def _clip(edges: Array) -> Array:
    """Return the ends of edges (n, 2, 3) that are not before the near plane, and where they cut it.

    In the camera frame, (m, 3) [m].
    """
    depths = edges[..., 2]
    crossing = (depths.min(axis=1) < NEAR_M) & (depths.max(axis=1) > NEAR_M)
    share = (NEAR_M - depths[crossing, :1]) / np.diff(depths[crossing], axis=1)
    cuts = edges[crossing, 0] + share * (edges[crossing, 1] - edges[crossing, 0])
    return np.concatenate([edges[depths >= NEAR_M], cuts])
