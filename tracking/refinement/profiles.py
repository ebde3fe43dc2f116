"""Grey profiles across the edges of the cube: where to look, and what is found there."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tracking.cube.edges import EdgeModel
from tracking.geometry.image_region import Floats, Patch
from tracking.geometry.projection import MIN_DEPTH, Projection

Array = NDArray[np.float64]

NARROWEST = 2.5
"""Smallest cell across an edge [px]: below, the two edges of a cell blur into one."""

END_CLEARANCE = 1.5
"""Points nearer to the end of an edge [px] are left out: blur rounds corners."""

REACH = 3.5
"""Half the length of a profile [px], and never more than half a cell."""

WIDE_REACH = (14.0, 0.9)
"""Half the length of a profile of the wide search [px], and at most in cells: the outlines of the
markers alone have nothing but paper for a whole cell beside them."""

TAPS = 9
"""Samples in a profile."""

MODEL_ERROR = 0.04
"""Error of a single edge place that does not come from noise [px]: neighbouring cells, sampling."""


@dataclass(frozen=True)
class EdgeProfiles:
    """Edge points in view, and the straight lines in the picture that cross them."""

    model: EdgeModel
    """The edges of the faces in view."""

    numbers: NDArray[np.intp]
    """Which points of `model` these are, rising, (N,)."""

    pixels: Array
    """Where they are seen, (N, 2) [px]."""

    normals: Array
    """Unit vectors across the edges, from black to white, (N, 2)."""

    slopes: Array
    """How far each edge moves along its normal with a shift-turn, (N, 6) [px]."""

    reach: Array
    """Half the length of each profile, (N,) [px]."""

    sweep: Array
    """How far each edge moved across itself while the shutter was open, (N,) [px]."""

    @property
    def face(self) -> NDArray[np.intp]:
        """Number of each point's face, (N,)."""
        return self.model.face[self.numbers]


def lay_out(
    model: EdgeModel,
    projection: Projection,
    camera_from_cube: Array,
    patch: Patch,
    sweep: Array | None,
    wide: bool,
) -> EdgeProfiles | None:
    """Lay profiles across the edges of a cube at a pose.

    Parameters
    ----------
    model
        The edges of the faces in view.
    projection
        The camera.
    camera_from_cube
        The pose, (4, 4).
    patch
        The picture; edges outside it are left out.
    sweep
        Shift-turn of the cube while the shutter was open, (6,), or None for a cube at rest.
    wide
        Whether to take the outlines alone, and to look a whole cell far.

    Returns
    -------
    None where the cube is too near to be seen.
    """
    turned = model.points @ camera_from_cube[:3, :3].T
    points = turned + camera_from_cube[:3, 3]
    if not len(points) or points[:, 2].min() < MIN_DEPTH:
        return None
    pixels, by_place = projection.project_with_jacobian(points)
    turn = camera_from_cube[:3, :3]
    along = _pushed(by_place, model.along @ turn.T)
    across = _pushed(by_place, model.across @ turn.T)
    length = np.sqrt((along * along).sum(axis=1))
    normals = np.stack([-along[:, 1], along[:, 0]], axis=1) / length[:, None]
    cell = (normals * across).sum(axis=1)
    normals *= np.sign(cell)[:, None]
    cell = np.abs(cell)
    by_point = normals[:, 0, None] * by_place[:, 0] + normals[:, 1, None] * by_place[:, 1]
    slopes = np.concatenate([by_point, _cross(turned, by_point)], axis=1)
    swept = np.zeros(len(cell)) if sweep is None else np.abs(slopes @ sweep)
    if wide:
        reach = np.minimum(WIDE_REACH[0], cell * WIDE_REACH[1])
    else:
        reach = np.minimum(np.maximum(REACH, 0.75 * swept + 2), cell / 2)
    good = (cell > NARROWEST) & (patch.room(pixels) > reach + 1) & (swept < cell)
    good &= model.to_end * length > END_CLEARANCE
    if wide:
        good &= model.outline
    found = np.flatnonzero(good)
    return EdgeProfiles(
        model, found, pixels[found], normals[found], slopes[found], reach[found], swept[found]
    )


def offsets(
    patch: Patch, profiles: EdgeProfiles, shifts: Array | float, blur: float
) -> "EdgeMeasurements":
    """Fit a blurred step to the picture across each edge point.

    The model a + b·S(u/σ) − b·δ·s(u/σ)/σ, (S a smooth step, s its slope), is linear in a, b and
    b·δ, and its parts are orthogonal after centring: no iteration, no matrix.

    Parameters
    ----------
    patch
        The picture.
    profiles
        Where to look.
    shifts
        How far beside their places the profiles begin, along the normals, (N,) [px].
    blur
        Width of a step at rest [px].

    Returns
    -------
    What was found, with offsets from the shifted places.
    """
    reach, normals = profiles.reach.astype(np.float32), profiles.normals.astype(np.float32)
    places = profiles.pixels + np.reshape(shifts, (-1, 1)) * profiles.normals
    inner = (places - (patch.left, patch.top)).astype(np.float32)
    taps = UNIT_TAPS * reach[:, None]
    x = inner[:, 0, None] + taps * normals[:, 0, None]
    y = inner[:, 1, None] + taps * normals[:, 1, None]
    values = patch.inside(x, y)
    # A swept edge is a ramp; a smooth step of 0.35 of its length is the nearest of this family.
    wide = np.sqrt(blur**2 + (0.35 * profiles.sweep) ** 2)
    width = np.minimum(wide, profiles.reach * 0.45).astype(np.float32)[:, None]
    step = np.tanh(taps / width) / 2
    slope = (0.25 - step * step) * (2 / width)
    slope -= slope.mean(axis=1, keepdims=True)
    contrast = _dot(step, values) / _dot(step, step)
    energy = _dot(slope, slope)
    shifted = -_dot(slope, values) / energy
    safe = np.where(np.abs(contrast) > 1, contrast, 1)
    # Two grey levels of noise; its true size is found from the residuals.
    variance = 4 / (safe * safe * energy) + MODEL_ERROR**2
    half = TAPS // 2
    rise = (values[:, half + 1] - values[:, half - 1]).astype(np.float64)
    fitted = contrast * (step[:, half + 1] - step[:, half - 1])
    level = values.mean(axis=1).astype(np.float64)
    return EdgeMeasurements(shifted / safe, contrast, level, 1 / variance, rise, fitted)


@dataclass(frozen=True)
class EdgeMeasurements:
    """What profiles show, each (N,)."""

    offset: Array
    """Offset of the edge along the normal [px]."""

    contrast: Array
    """Height of the step, white over black [grey levels]."""

    level: Array
    """Mean of the picture along the profile [grey levels]."""

    information: Array
    """About the offset [1/px²]."""

    rise: Array
    """How much the picture rises over the middle quarter of the profile [grey levels]."""

    fitted: Array
    """The same of the step that was fitted."""


def _dot(a: Floats, b: Floats) -> Array:
    """Sum the products of rows, (N, M) and (N, M) → (N,)."""
    return np.asarray(np.einsum("ij,ij->i", a, b), np.float64)


UNIT_TAPS = np.linspace(-1, 1, TAPS, dtype=np.float32)[None]


def _pushed(slopes: Array, vectors: Array) -> Array:
    """Project vectors, (N, 3), by the slopes of their points, (N, 2, 3) → (N, 2)."""
    return np.asarray(np.matmul(slopes, vectors[:, :, None])[:, :, 0], np.float64)


def _cross(a: Array, b: Array) -> Array:
    """Cross products of rows, (N, 3); three times faster than `np.cross`."""
    x = a[:, 1] * b[:, 2] - a[:, 2] * b[:, 1]
    y = a[:, 2] * b[:, 0] - a[:, 0] * b[:, 2]
    z = a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]
    return np.asarray(np.stack([x, y, z], axis=1), np.float64)
