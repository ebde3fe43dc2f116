"""The edges of one marker, measured in a picture whose lens is not known yet.

OpenCV's corners lie a few tenths of a pixel off, by gamma and blur. Here every black and white edge
of a marker is measured across itself, as in `tracking.refinement.edge_refinement`; what says where
to look is not a camera but a smooth map from the marker to the picture: a homography bent by a
quadratic, which follows any lens over so small a part of the picture.
"""

from dataclasses import dataclass, replace

import cv2
import numpy as np
from numpy.typing import NDArray

from tracking.calibration.view import View
from tracking.cube.marker import marker_cells
from tracking.cube.model import CubeModel, Face
from tracking.detection.markers import Observation
from tracking.geometry.image_region import Patch

Array = NDArray[np.float64]

POINTS_PER_CELL = 2
"""Points on each cell's length of an edge."""

END_CLEARANCE = 2.5
"""Points nearer to the end of an edge [px] are left out: blur rounds corners."""

REACH = 3.5
"""Half the length of a profile [px], and never more than 0.45 of a cell."""

NARROWEST = 4.0
"""Smallest cell across an edge [px] that is measured."""

TAPS = 13
"""Samples in a profile."""

WIDTHS = (2.0, 1.3, 1.0, 1.0)
"""Widths of the step that is fitted [px], one for each round."""

FAINT = 0.5
"""An edge with less than this share of the marker's usual contrast is covered."""

FEWEST = 40
"""A marker with fewer good edge points than this is not used."""


class EdgeMeter:
    """Measures the markers of one cube."""

    def __init__(self, cube: CubeModel) -> None:
        self._layouts = {
            face.name: (number, face, _layout(cube, face)) for number, face in enumerate(cube.faces)
        }

    def measure(self, patch: Patch, seen: Observation, timestamp: float) -> View | None:
        """Measure the edges of one marker that was found; None where they cannot be seen well."""
        number, face, layout = self._layouts[seen.face.name]
        square = np.array([(0, 0), (1, 0), (1, 1), (0, 1)], np.float32)
        homography = cv2.getPerspectiveTransform(square, seen.corners.astype(np.float32))
        warp = _Warp(np.asarray(homography, np.float64), np.zeros((6, 2)))
        for width in WIDTHS:
            edges = _measured(patch, layout, warp, width)
            if edges is None:
                return None
            chosen, pixels, normals, offset = edges
            step, kept = _bent(layout.places[chosen], normals, offset)
            warp = replace(warp, bend=warp.bend + step)
        chosen, pixels, normals, offset = chosen[kept], pixels[kept], normals[kept], offset[kept]
        if len(chosen) < FEWEST:
            return None
        top_left, top_right, _, bottom_left = face.corners
        axes = np.stack([top_right - top_left, bottom_left - top_left])
        return View(
            timestamp,
            np.full(len(chosen), number, np.intp),
            top_left + layout.places[chosen] @ axes,
            pixels + offset[:, None] * normals,
            normals,
            np.ones(len(chosen)),
            layout.lines[chosen],
        )


@dataclass(frozen=True)
class _Layout:
    """Points on a marker's edges, in its unit square: x right, y down."""

    places: Array
    along: Array
    across: Array
    to_end: Array
    lines: NDArray[np.intp]


@dataclass(frozen=True)
class _Warp:
    """The map from a marker's unit square to the picture."""

    homography: Array
    bend: Array

    def __call__(self, places: Array) -> Array:
        """Map places (N, 2) to pixels (N, 2)."""
        flat = np.column_stack([places, np.ones(len(places))]) @ self.homography.T
        return np.asarray(flat[:, :2] / flat[:, 2:] + _powers(places) @ self.bend, np.float64)

    def steps(self, places: Array, way: Array) -> Array:
        """Return how a small way in the square looks in the picture, (N, 2) [px]."""
        return self(places + way / 2) - self(places - way / 2)


def _measured(
    patch: Patch, layout: _Layout, warp: _Warp, width: float
) -> tuple[NDArray[np.intp], Array, Array, Array] | None:
    """Measure across the edges: numbers of the good ones, pixels, normals, offsets [px]."""
    pixels = warp(layout.places)
    tangents = warp.steps(layout.places, layout.along)
    length = np.linalg.norm(tangents, axis=1)
    normals = np.stack([-tangents[:, 1], tangents[:, 0]], axis=1) / length[:, None]
    cell = np.einsum("ni,ni->n", normals, warp.steps(layout.places, layout.across))
    normals *= np.sign(cell)[:, None]
    reach = np.minimum(REACH, 0.45 * np.abs(cell))
    good = (np.abs(cell) > NARROWEST) & (layout.to_end * length > END_CLEARANCE)
    good &= patch.room(pixels) > reach + 2
    if np.count_nonzero(good) < FEWEST:
        return None
    offset, contrast = _offsets(patch, pixels[good], normals[good], reach[good], width)
    strong = contrast > max(10.0, FAINT * float(np.quantile(contrast, 0.7)))
    strong &= np.abs(offset) < 0.7 * reach[good]
    if np.count_nonzero(strong) < FEWEST:
        return None
    chosen = np.flatnonzero(good)[strong]
    return chosen, pixels[chosen], normals[chosen], offset[strong]


def _layout(cube: CubeModel, face: Face) -> _Layout:
    """Lay points on a marker's edges."""
    white = np.pad(~marker_cells(cube.dictionary, face.marker_id), 1, constant_values=True)
    upright, level = _runs(white), _runs(white.T)
    rows = np.concatenate([upright, level[:, [1, 0, 3, 2, 5, 4, 6, 7]]])
    rows[len(upright) :, 7] += upright[:, 7].max() + 1
    count = len(white) - 2
    places, along, across = (rows[:, pair : pair + 2] / count for pair in (0, 2, 4))
    return _Layout(places, along, across, rows[:, 6], rows[:, 7].astype(np.intp))


def _runs(white: NDArray[np.bool_]) -> Array:
    """List points on upright edges: x y, along (2), across to white (2), to end, line; in cells."""
    rows: list[tuple[float, ...]] = []
    line = 0
    for column in range(1, white.shape[1]):
        polarity = white[:, column].astype(int) - white[:, column - 1]
        for run in np.split(np.arange(len(white)), np.flatnonzero(np.diff(polarity)) + 1):
            side = int(polarity[run[0]])
            if side == 0:
                continue
            for place in (np.arange(len(run) * POINTS_PER_CELL) + 0.5) / POINTS_PER_CELL:
                end = float(min(place, len(run) - place))
                rows.append((column - 1, run[0] - 1 + place, 0, 1, side, 0, end, line))
            line += 1
    return np.array(rows, np.float64)


def _powers(places: Array) -> Array:
    u, v = (places - 0.5).T
    return np.stack([np.ones(len(u)), u, v, u * u, u * v, v * v], axis=1)


def _bent(places: Array, normals: Array, offset: Array) -> tuple[Array, NDArray[np.bool_]]:
    """Fit the change of the map, and of the bloom, to what was measured across the edges.

    Returns
    -------
    Change of `bend`, (6, 2), and which points agree with it, (N,).
    """
    powers = _powers(places)
    rows = np.concatenate(
        [powers * normals[:, :1], powers * normals[:, 1:], np.ones((len(powers), 1))], axis=1
    )
    weights = np.ones(len(rows))
    for _ in range(4):
        weighted = rows * weights[:, None]
        # A trace of a prior keeps it solvable where only edges of one direction are seen.
        normal = weighted.T @ rows + 1e-3 * np.eye(rows.shape[1])
        solution = np.linalg.solve(normal, weighted.T @ offset)
        residual = np.abs(offset - rows @ solution)
        cut = max(4.685 * 1.4826 * float(np.median(residual)), 0.1)
        weights = np.square(np.clip(1 - (residual / cut) ** 2, 0, None))
    return solution[:12].reshape(2, 6).T, weights > 0.1


def _offsets(
    patch: Patch, pixels: Array, normals: Array, reach: Array, width: float
) -> tuple[Array, Array]:
    """Fit a blurred step across each edge, as `edge_refinement` does: offset [px], contrast."""
    taps = np.linspace(-1, 1, TAPS)[None] * reach[:, None]
    values = patch.at(pixels[:, None] + taps[..., None] * normals[:, None]).astype(np.float64)
    soft = np.minimum(width, reach * 0.45)[:, None]
    step = np.tanh(taps / soft) / 2
    slope = (0.25 - step**2) * 2 / soft
    slope -= slope.mean(axis=1, keepdims=True)
    contrast = (step * values).sum(axis=1) / (step**2).sum(axis=1)
    shifted = -(slope * values).sum(axis=1) / (slope**2).sum(axis=1)
    return shifted / np.where(np.abs(contrast) > 1, contrast, 1), contrast
