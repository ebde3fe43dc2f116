"""The real cubes in the camera's picture, which hide what is behind them."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Self

import cv2
import moderngl
import numpy as np
from numpy.typing import NDArray

from characters.rendering.programs import Programs, assign
from characters.rendering.projection import NEAR, is_rigid, part_that_shows
from characters.rendering.scene import Box, Rectangle

Array = NDArray[np.float64]

_FACE = np.array([(-1, -1, 1), (1, -1, 1), (1, 1, 1), (-1, -1, 1), (1, 1, 1), (-1, 1, 1)]) / 2
UNIT_CUBE = np.concatenate([s * np.roll(_FACE, axis, axis=1) for axis in range(3) for s in (1, -1)])
"""Corners of its twelve triangles, (36, 3)."""

_ENDS = np.array([(a, a | b) for a in range(8) for b in (1, 2, 4) if not a & b])
_CORNERS = (np.arange(8)[:, None] >> np.arange(3) & 1) - 0.5
EDGES = _CORNERS[_ENDS]
"""Both ends of its twelve edges, (12, 2, 3)."""

SIDES = 10
"""Sides that the outline of a cube has at most, were it cut off before the lens; `SIDES` in the
shaders too. One that is wholly before the camera has six."""

MOST = 8
"""Cubes that a part of the picture knows at most, the nearest ones; `MOST` in the shaders too."""


@dataclass(frozen=True)
class Outlines:
    """Outlines of cubes in a part of the picture: what of the table is inside, they hide."""

    count: int
    """Of cubes."""

    longest: int
    """How many sides the one with the most has."""

    sides: Array
    """(`MOST`, `SIDES`, 3). A side times (x, y, 1), a place in the part with the corner of its
    first pixel as the origin, is how far inside of it that is [px]."""

    @classmethod
    def of(cls, boxes: Sequence[Box], matrix: Array, part: Rectangle) -> Self:
        """Return the outlines of some boxes under the pinhole `matrix` (3, 3) of the picture."""
        nearest = sorted(boxes, key=lambda box: float(np.linalg.norm(box.camera_from_box[:3, 3])))
        sides = np.zeros((MOST, SIDES, 3))
        sides[..., 2] = 1e6  # a side that is not there leaves everything inside
        longest = 0
        for row, box in zip(sides, nearest, strict=False):
            found = _outline(box, matrix)
            row[: len(found)] = found @ _shift(part)
            longest = max(longest, len(found))
        return cls(min(len(boxes), MOST), longest, sides)


class Cubes:
    """Hides figures behind the real cubes.

    Parameters
    ----------
    context, programs
        Where to draw.
    """

    def __init__(self, context: moderngl.Context, programs: Programs) -> None:
        self._context = context
        self._programs = programs
        self._corners = context.buffer(UNIT_CUBE.astype("f4"))
        self._box = context.vertex_array(programs.box, [(self._corners, "3f", "position")])

    def hide(self, boxes: Sequence[Box], clip_from_camera: Array) -> None:
        """Write the depth of the real cubes into the framebuffer in use, and no colour."""
        if not boxes:
            return
        framebuffer = self._context.fbo
        framebuffer.color_mask = False, False, False, False
        framebuffer.use()  # masks take effect then
        self._context.enable_only(moderngl.DEPTH_TEST)
        for box in boxes:
            clip = clip_from_camera @ box.camera_from_box @ np.diag([*(3 * [box.edge]), 1.0])
            assign(self._programs.box, clip_from_box=clip)
            self._box.render(moderngl.TRIANGLES)
        framebuffer.color_mask = True, True, True, True
        framebuffer.use()

    def release(self) -> None:
        """Give the card's memory back; a second call does nothing."""
        self._box.release()
        self._corners.release()


def that_show(
    boxes: Sequence[Box], matrix: Array, size: tuple[int, int]
) -> list[tuple[Box, Rectangle]]:
    """Return the boxes that are seen, each with the part of the picture around it."""
    seen = []
    for box in boxes:
        if is_rigid(box.camera_from_box) and np.isfinite(box.edge) and box.edge > 0.0:
            part = part_that_shows(box.edge * UNIT_CUBE, matrix, box.camera_from_box, size)
            if part is not None:
                seen.append((box, part))
    return seen


def _shift(part: Rectangle) -> Array:
    """Return the map (3, 3) from places in a part to pixels, whose centres are whole numbers."""
    return np.array([[1.0, 0.0, part.x - 0.5], [0.0, 1.0, part.y - 0.5], [0.0, 0.0, 1.0]])


def _outline(box: Box, matrix: Array) -> Array:
    """Return lines (n, 3) around what is seen of a box, positive inside."""
    pose = np.asarray(box.camera_from_box, float)
    ends = box.edge * EDGES @ pose[:3, :3].T + pose[:3, 3]
    depths = ends[..., 2]
    crossing = (depths.min(axis=1) < NEAR) & (depths.max(axis=1) > NEAR)
    share = (NEAR - depths[crossing, :1]) / np.diff(depths[crossing], axis=1)
    cuts = ends[crossing, 0] + share * (ends[crossing, 1] - ends[crossing, 0])
    seen = np.concatenate([ends[depths >= NEAR], cuts])
    pixels = (seen / seen[:, 2:]) @ matrix[:2].T
    hull = cv2.convexHull(pixels.astype(np.float32))[:, 0].astype(float)
    along = np.roll(hull, -1, axis=0) - hull
    inward = np.stack([-along[:, 1], along[:, 0]], axis=1)
    inward /= np.maximum(np.linalg.norm(along, axis=1, keepdims=True), 1e-9)
    lines = np.column_stack([inward, -np.einsum("ij,ij->i", inward, hull)])
    return np.asarray(lines * np.sign(lines @ [*hull.mean(axis=0), 1.0])[:, None])[:SIDES]
