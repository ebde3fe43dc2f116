"""Measuring the edges of one marker in an image whose lens is not known yet.

OpenCV's corners are off by a few tenths of a pixel, through gamma and blur. Here every edge is
measured across itself, as in `tracking.refinement.edges.edge_refinement`; not a camera, but a
homography plus a quadratic, which can follow any lens over so small a part of the image, predicts
the edges.
"""

from dataclasses import dataclass, replace

import cv2
import numpy as np

from cubeling.tracking.calibration.view import View
from cubeling.tracking.cube.edges import edge_points
from cubeling.tracking.cube.marker import marker_cells
from cubeling.tracking.cube.model import CubeModel, Face
from cubeling.tracking.detection.markers import Observation
from cubeling.tracking.geometry.arrays import Array, Flags, Indices
from cubeling.tracking.geometry.image_region import Patch
from cubeling.tracking.geometry.robust_statistics import tukey_weight

POINTS_PER_CELL = 2
"""Number of measured points along one cell."""

MIN_END_DISTANCE_PX = 2.5
"""Points nearer to the end of an edge are left out: blur rounds the corners."""

MAX_REACH_PX, MAX_REACH_CELLS = 3.5, 0.45
"""Half the length of a profile: the smaller of the two."""

MIN_CELL_PX = 4.0
"""Smallest cell, measured across the edge, that is used."""

SAMPLES_PER_PROFILE = 13
"""Number of samples in a profile."""

STEP_WIDTHS_PX = (2.0, 1.3, 1.0, 1.0)
"""Width of the fitted step in each iteration."""

MIN_CONTRAST_RATIO = 0.5
"""An edge with less than this share of the marker's usual contrast is hidden by something."""

MIN_POINTS = 40
"""Minimum number of good points on a marker."""


class MarkerEdgeMeter:
    """Measures the edges of the markers of one cube."""

    def __init__(self, cube: CubeModel) -> None:
        self._layouts = {
            face.name: (number, face, _layout(cube, face)) for number, face in enumerate(cube.faces)
        }

    def measure(self, patch: Patch, seen: Observation, timestamp: float) -> View | None:
        """Measure the edges of a detected marker; None if they are not clearly visible."""
        number, face, layout = self._layouts[seen.face.name]
        square = np.array([(0, 0), (1, 0), (1, 1), (0, 1)], np.float32)
        homography = cv2.getPerspectiveTransform(square, seen.corners.astype(np.float32))
        warp = _Warp(np.asarray(homography, np.float64), np.zeros((6, 2)))
        for width in STEP_WIDTHS_PX:
            edges = _measure(patch, layout, warp, width)
            if edges is None:
                return None
            chosen, pixels, normals, offset = edges
            step, inliers = _fit_bend(layout.points[chosen], normals, offset)
            warp = replace(warp, bend=warp.bend + step)
        chosen, pixels = chosen[inliers], pixels[inliers]
        normals, offset = normals[inliers], offset[inliers]
        if len(chosen) < MIN_POINTS:
            return None
        top_left, top_right, _, bottom_left = face.corners
        axes = np.stack([top_right - top_left, bottom_left - top_left])
        return View(
            timestamp,
            np.full(len(chosen), number, np.intp),
            top_left + layout.points[chosen] @ axes,
            pixels + offset[:, None] * normals,
            normals,
            np.ones(len(chosen)),
            layout.lines[chosen],
        )


@dataclass(frozen=True)
class _Layout:
    """Points on the edges of a marker, in its unit square: x right, y down."""

    points: Array
    """Positions, (N, 2)."""

    along: Array
    """One cell along the edge, (N, 2)."""

    across: Array
    """One cell across the edge, from black to white, (N, 2)."""

    end_distances: Array
    """Distance to the nearer end of the edge [cells], (N,)."""

    lines: Indices
    """Index of the edge, (N,)."""


@dataclass(frozen=True)
class _Warp:
    """The map from a marker's unit square to the image."""

    homography: Array
    """(3, 3)."""

    bend: Array
    """Coefficients of the quadratic that is added to the homography, (6, 2) [px]."""

    def __call__(self, points: Array) -> Array:
        """Map points (N, 2) to pixels (N, 2)."""
        projected = np.column_stack([points, np.ones(len(points))]) @ self.homography.T
        bend = _quadratic_terms(points) @ self.bend
        return np.asarray(projected[:, :2] / projected[:, 2:] + bend, np.float64)

    def difference(self, points: Array, step: Array) -> Array:
        """Map a step about each point, both (N, 2), to the image, (N, 2) [px]."""
        return self(points + step / 2) - self(points - step / 2)


def _measure(
    patch: Patch, layout: _Layout, warp: _Warp, width: float
) -> tuple[Indices, Array, Array, Array] | None:
    """Measure across the edges: indices of the good points, pixels, normals, offsets [px]."""
    pixels = warp(layout.points)
    tangents = warp.difference(layout.points, layout.along)
    length = np.linalg.norm(tangents, axis=1)
    normals = np.stack([-tangents[:, 1], tangents[:, 0]], axis=1) / length[:, None]
    cell = np.einsum("ni,ni->n", normals, warp.difference(layout.points, layout.across))
    normals *= np.sign(cell)[:, None]
    reach = np.minimum(MAX_REACH_PX, MAX_REACH_CELLS * np.abs(cell))
    good = np.abs(cell) > MIN_CELL_PX
    good &= layout.end_distances * length > MIN_END_DISTANCE_PX
    good &= patch.border_distance(pixels) > reach + 2
    if np.count_nonzero(good) < MIN_POINTS:
        return None
    offset, contrast = _fit_steps(patch, pixels[good], normals[good], reach[good], width)
    strong = contrast > max(10.0, MIN_CONTRAST_RATIO * float(np.quantile(contrast, 0.7)))
    strong &= np.abs(offset) < 0.7 * reach[good]
    if np.count_nonzero(strong) < MIN_POINTS:
        return None
    chosen = np.flatnonzero(good)[strong]
    return chosen, pixels[chosen], normals[chosen], offset[strong]


def _layout(cube: CubeModel, face: Face) -> _Layout:
    """Place points on the edges of a marker."""
    cells = marker_cells(cube.dictionary, face.marker_id)
    rows = edge_points(cells, POINTS_PER_CELL)
    points, along, across = (rows[:, pair : pair + 2] / len(cells) for pair in (0, 2, 4))
    return _Layout(points, along, across, rows[:, 6], rows[:, 7].astype(np.intp))


def _quadratic_terms(points: Array) -> Array:
    u, v = (points - 0.5).T
    return np.stack([np.ones(len(u)), u, v, u * u, u * v, v * v], axis=1)


def _fit_bend(points: Array, normals: Array, offset: Array) -> tuple[Array, Flags]:
    """Fit the change of the map, and the bloom, to the offsets measured across the edges.

    Return the change of `bend`, (6, 2), and which points agree with it, (N,), by robust least
    squares with Tukey's biweight.
    """
    terms = _quadratic_terms(points)
    bloom = np.ones((len(terms), 1))
    rows = np.concatenate([terms * normals[:, :1], terms * normals[:, 1:], bloom], axis=1)
    weights = np.ones(len(rows))
    for _ in range(4):
        weighted = rows * weights[:, None]
        # A weak prior keeps it solvable if edges of only one direction are visible.
        normal = weighted.T @ rows + 1e-3 * np.eye(rows.shape[1])
        solution = np.linalg.solve(normal, weighted.T @ offset)
        residual = np.abs(offset - rows @ solution)
        weights = tukey_weight(residual, max(4.685 * 1.4826 * float(np.median(residual)), 0.1))
    return solution[:12].reshape(2, 6).T, weights > 0.1


def _fit_steps(
    patch: Patch, pixels: Array, normals: Array, reach: Array, width: float
) -> tuple[Array, Array]:
    """Fit a blurred step across each edge, as `edge_refinement` does: offset [px], contrast."""
    positions = np.linspace(-1, 1, SAMPLES_PER_PROFILE)[None] * reach[:, None]
    places = pixels[:, None] + positions[..., None] * normals[:, None]
    values = patch.sample(places).astype(np.float64)
    softness = np.minimum(width, reach * 0.45)[:, None]
    step = np.tanh(positions / softness) / 2
    slope = (0.25 - step**2) * 2 / softness
    slope -= slope.mean(axis=1, keepdims=True)
    contrast = (step * values).sum(axis=1) / (step**2).sum(axis=1)
    shift = -(slope * values).sum(axis=1) / (slope**2).sum(axis=1)
    return shift / np.where(np.abs(contrast) > 1, contrast, 1), contrast
