"""The part of the image around the cube in which the hand is looked for, at working resolution."""

import math
from dataclasses import dataclass, replace

import cv2
import numpy as np

from cubeling.tracking.appearance.hand.background import GRID_PX, Box
from cubeling.tracking.cube.model import CubeModel
from cubeling.tracking.geometry.arrays import Array, Image
from cubeling.tracking.geometry.projection import MIN_DEPTH, Projection

REACH_EDGES = 2.0
"""How far from the cube's bounds the hand is looked for [apparent edges of the cube]."""

WORKING_EDGE_PX, MIN_EDGE_PX, MAX_EDGE_PX = 30.0, 17.0, 48.0
"""Edge of the cube at the resolution in which the hand is looked for, and the bounds at which that
resolution changes [px]."""

MARGIN_PX = 7
"""Pixels of the window around the cube that take part in filters over it."""

MIN_SIDE_PX = 8
"""Least side of a window [px of it]."""

STILL_FRAMES = 7
"""Frames in turn that are not looked at while a window shows the same."""

STILL_PX, STILL_LEVELS, MIN_CHANGE_EDGES2 = 0.1, 8, 0.02
"""It shows the same if no corner of the cube moves further [px of the window], and a smaller area
[square edges] changes by more [levels of 255]: a finger's tip is larger."""


@dataclass(frozen=True)
class HandWindow:
    """A part of the image at working resolution."""

    left: int
    """First column [px of the window]: a multiple of `GRID_PX` where it is no part of another."""

    top: int
    """First row [px of the window]: also a multiple."""

    width: int
    """Number of columns, in pixels of the picture."""

    height: int
    """Number of rows, in pixels of the picture."""

    scale: int
    """Pixels of the image per pixel of the window."""

    edge: float
    """Apparent edge of the cube [px of the window]."""

    quads: Array
    """Where the faces' prints are, seen or not, (faces, 4, 2) [px of the window]."""

    cube_box: Box
    """Rows and columns of the window with the cube, at least one."""

    @property
    def box(self) -> Box:
        """Rows and columns in an image of the working resolution."""
        return np.s_[self.top : self.top + self.height, self.left : self.left + self.width]

    @property
    def samples(self) -> Box:
        """Rows and columns of the samples whose squares are in it, see `sample`."""
        rows, columns = (slice(side.start // GRID_PX, side.stop // GRID_PX) for side in self.box)
        return rows, columns

    @property
    def image_box(self) -> Box:
        """Rows and columns in the image."""
        rows, columns = self.box
        return (
            slice(rows.start * self.scale, rows.stop * self.scale),
            slice(columns.start * self.scale, columns.stop * self.scale),
        )

    def part(self, box: Box) -> "HandWindow":
        """Return a part of the window, with some rows and columns of it, that holds the cube."""
        rows, columns = (
            range(side)[part] for side, part in zip((self.height, self.width), box, strict=True)
        )
        cube_rows, cube_columns = (
            slice(cube.start - part.start, cube.stop - part.start)
            for cube, part in zip(self.cube_box, (rows, columns), strict=True)
        )
        return replace(
            self,
            left=self.left + columns.start,
            top=self.top + rows.start,
            width=len(columns),
            height=len(rows),
            quads=self.quads - (columns.start, rows.start),
            cube_box=(cube_rows, cube_columns),
        )

    def cube_quads(self) -> Array:
        """Where the faces' prints are in `cube_box`, (faces, 4, 2) [px of it]."""
        rows, columns = self.cube_box
        return self.quads - (columns.start, rows.start)


class WindowFinder:
    """Finds the window at a pose; its resolution follows the apparent size of the cube."""

    def __init__(self, cube: CubeModel, projection: Projection, prints: Array) -> None:
        self._projection, self._edge = projection, cube.edge
        self._points = np.concatenate([cube.vertices, prints.reshape(-1, 3)])
        self._vertices = len(cube.vertices)

    def window(self, camera_from_cube: Array, scale: int = 0) -> HandWindow | None:
        """Return the window at a pose, (4, 4); None where the cube is hardly in the picture.

        `scale` is that of the window before, which is kept as long as it suits; 0 without one.
        """
        points = self._points @ camera_from_cube[:3, :3].T + camera_from_cube[:3, 3]
        if points[:, 2].min() < MIN_DEPTH:
            return None
        pixels = self._projection.project(points)
        depth = float(camera_from_cube[2, 3])
        edge = self._edge * float(self._projection.matrix[0, 0]) / depth
        if not scale or not MIN_EDGE_PX < edge / scale < MAX_EDGE_PX:
            scale = max(1, round(edge / WORKING_EDGE_PX))
        reach = REACH_EDGES * edge
        body, prints = pixels[: self._vertices], pixels[self._vertices :]
        quads = (prints + 0.5) / scale - 0.5
        bounds = (
            each.tolist() for part in (body, quads) for each in (part.min(axis=0), part.max(axis=0))
        )
        ranges = []
        for low, high, first, last, side in zip(*bounds, self._projection.size, strict=True):
            start = max(math.floor((low - reach) / scale) // GRID_PX * GRID_PX, 0)
            length = min(math.ceil((high + reach) / scale), side // scale) - start
            if length < MIN_SIDE_PX:
                return None
            begin = min(max(int(first) - start - MARGIN_PX, 0), length - 1)
            end = min(max(math.ceil(last) - start + MARGIN_PX, begin + 1), length)
            ranges.append((start, length, slice(begin, end)))
        (left, width, columns), (top, height, rows) = ranges
        quads = (quads - (left, top)).reshape(-1, 4, 2)
        return HandWindow(left, top, width, height, scale, edge / scale, quads, (rows, columns))


class Stillness:
    """Tells whether a window shows what it showed when it was last looked at."""

    def __init__(self) -> None:
        self._window: HandWindow | None = None
        self._picture: Image = np.zeros((0, 0, 3), np.uint8)
        self._frames = 0

    def is_still(self, window: HandWindow, picture: Image) -> bool:
        """Return True for at most `STILL_FRAMES` in turn; False means that it is looked at now.

        `picture` is the window in samples, (h, w, 3) BGR.
        """
        self._frames += 1
        if self._frames <= STILL_FRAMES and self._is_same(window, picture):
            return True
        self._window, self._picture, self._frames = window, picture, 0
        return False

    def _is_same(self, window: HandWindow, picture: Image) -> bool:
        last = self._window
        if last is None or (last.scale, last.box) != (window.scale, window.box):
            return False
        if np.abs(last.quads - window.quads).max() > STILL_PX:
            return False
        changed = np.count_nonzero(cv2.absdiff(picture, self._picture) > STILL_LEVELS)
        return bool(changed < MIN_CHANGE_EDGES2 * (window.edge / GRID_PX) ** 2)


def sample(image: Image, scale: int, samples: Box) -> Image:
    """Return the middles of some squares of `GRID_PX` pixels at working resolution, (h, w, 3) BGR.

    `samples` counts rows and columns of such squares, which are in the image.
    """
    step = GRID_PX * scale
    rows, columns = (
        slice(step * side.start + (step - 1) // 2, step * side.stop) for side in samples
    )
    return _every(step, image[rows, columns])


def _every(step: int, image: Image) -> Image:
    """Return each `step`th pixel of each `step`th row, from the first on."""
    # In a quarter of the time that a slice with a step takes.
    share = 1 / step
    part = cv2.resize(image, None, fx=share, fy=share, interpolation=cv2.INTER_NEAREST)
    return np.asarray(part, np.uint8)


def shrink(image: Image, scale: int) -> Image:
    """Return a part of the image at working resolution, (h, w, 3) BGR: the mean of each square.

    Where `scale` is even, the outermost rows and columns of a square count half as much as others.
    """
    # In a third of the time that INTER_AREA takes.
    side = (scale - 1) | 1
    soft = np.asarray(cv2.blur(image, (side, side)) if side > 1 else image, np.uint8)
    if side == scale:
        return _every(scale, soft[side // 2 :, side // 2 :])
    size = (image.shape[1] // scale, image.shape[0] // scale)
    return np.asarray(cv2.resize(soft, size, interpolation=cv2.INTER_LINEAR), np.uint8)
