"""Grey profiles across the edges of the cube: where to measure, and the measurement."""

from dataclasses import dataclass, field
from functools import cached_property
from itertools import pairwise

import numpy as np

from cubeling.tracking.cube.edges import EdgeModel
from cubeling.tracking.geometry import se3
from cubeling.tracking.geometry.arrays import Array, Floats, Indices, run_starts
from cubeling.tracking.geometry.image_region import Patch
from cubeling.tracking.geometry.projection import MIN_DEPTH, Projection

MIN_CELL_PX = 2.5
"""Smallest cell across an edge: below, the two edges of a cell blur into one."""

END_CLEARANCE_PX = 1.5
"""Points nearer to the end of an edge are left out: blur rounds corners."""

REACH_PX = 3.5
"""Half the length of a profile, or more where motion blurs the edge; it is never more than half a
cell."""

TAPS_PER_PROFILE = 9
"""Samples in a profile."""

MODEL_ERROR_PX = 0.04
"""Error of a single edge position that is not noise: neighbouring cells, sampling."""

EDGE_WIDTH_PX, RAMP_WIDTH = 0.87, 0.35
"""Width of the smooth step that is closest to an edge of a cube at rest in a sharp image, and to a
motion-blurred edge, which is a ramp, as a share of its length."""

MAX_WIDTH = 0.45
"""Width of a fitted step, as a share of the reach, at most."""

WIDE_EXPONENT, GAIN_LOSS = 0.6, 0.11
"""A step that is wider than the edge finds it too far off, by their ratio to this power, and a
narrower one too near, by their ratio. An offset as large as the step is wide is found too small by
this share besides. Computed for smooth steps; both are right to a tenth."""

ROW_STEPS = 2
"""How often the row of a point in a rolling image is found."""

NO_MOTION = np.zeros(6)
"""The pose delta of a cube at rest."""

UNIT_TAPS = np.linspace(-1, 1, TAPS_PER_PROFILE, dtype=np.float32)[:, None]
"""Where those are, as shares of the reach, (taps, 1)."""


@dataclass(frozen=True)
class EdgeProfiles:
    """Edge points in view, and the line segments across the edges to measure along.

    The columns of its arrays are contiguous: numpy takes several times as long over short rows.
    """

    model: EdgeModel
    """The edges of the faces in view."""

    numbers: Indices
    """Indices of these points in `model`, ascending, (N,)."""

    pixels: Array
    """Their positions in the image, (N, 2) [px]."""

    normals: Array
    """Unit vectors across the edges, from black to white, (N, 2)."""

    slopes: Array
    """Jacobian of each edge position along its normal by a pose delta, (N, 6) [px]."""

    bends: Array | None
    """The same by a change of the radial distortion k1, (N,) [px]; None where it is known."""

    k1: float
    """The radial distortion, beyond that of the intrinsics, with which they are placed."""

    reach: Array
    """Half the length of each profile, (N,) [px]."""

    blur_motion: Array
    """How the cube moved during the exposure, as a pose delta, (6,)."""

    blur: Array
    """How far that moved each edge along its normal, (N,) [px]."""

    readout_motion: Array = field(default_factory=lambda: np.zeros(6))
    """How the cube moves while the shutter rolls from the first row to the last, as a pose delta,
    (6,)."""

    @cached_property
    def face(self) -> Indices:
        """Number of each point's face, (N,)."""
        return self.model.face[self.numbers]

    @cached_property
    def face_runs(self) -> list[slice]:
        """The points of each face, which follow each other."""
        bounds = [*run_starts(self.face).tolist(), len(self.face)]
        return [slice(start, end) for start, end in pairwise(bounds)]

    @cached_property
    def equations(self) -> Array:
        """Jacobian of each edge position by the unknowns of `EdgeFit.solution`, (K, N) [px]."""
        rows = [self.slopes.T, np.ones((1, len(self.blur))), self.blur[None]]
        return np.concatenate(rows if self.bends is None else [*rows, self.bends[None]])

    def shifts(self, solution: Array) -> Array:
        """How far `EdgeFit.solution` moves each edge along its normal, (N,) [px]."""
        shifts = self.slopes @ solution[:6]
        return shifts if self.bends is None else shifts + self.bends * float(solution[8])


@dataclass(frozen=True)
class EdgeMeasurements:
    """Measurements of profiles, each (N,)."""

    offset: Array
    """Offset of the edge along the normal [px]."""

    contrast: Array
    """Height of the step, white over black [grey levels]."""

    level: Array
    """Mean of the image along the profile [grey levels]."""

    information: Array
    """Information about the offset [1/px²]."""

    rise: Array
    """Rise of the image over the middle quarter of the profile [grey levels]."""

    fitted: Array
    """The same for the fitted step."""


def place_profiles(
    model: EdgeModel,
    projection: Projection,
    camera_from_cube: Array,
    patch: Patch,
    blur_motion: Array,
    k1: float = 0.0,
    readout_motion: Array = NO_MOTION,
) -> EdgeProfiles | None:
    """Place profiles across the edges in view of a cube at a pose, as far as a patch shows them.

    `blur_motion`, `k1` and `readout_motion` are as in `EdgeProfiles`; the pose is that at the time
    of the middle row. None where the cube is too close.
    """
    rotation, origin = camera_from_cube[:3, :3], camera_from_cube[:3, 3]
    rotated = rotation @ model.points.T
    points = rotated + origin[:, None]
    if not points.size or points[2].min() < MIN_DEPTH:
        return None
    if readout_motion.any():
        points = _at_their_rows(points, rotated, readout_motion, projection)
        if points[2].min() < MIN_DEPTH:
            return None
    pixels, by_point = projection.project_with_jacobian(points.T)
    jacobian = by_point.transpose(1, 2, 0)
    bends = None
    if projection.claims_no_distortion:
        bends = projection.bends(points.T, origin)
        pixels += k1 * bends
    along = (jacobian * (rotation @ model.along.T)).sum(axis=1)
    across = (jacobian * (rotation @ model.across.T)).sum(axis=1)
    length = np.sqrt((along * along).sum(axis=0))
    normals = np.stack([-along[1], along[0]]) / length
    cell = (normals * across).sum(axis=0)
    normals *= np.sign(cell)
    cell = np.abs(cell)
    by_point = normals[0] * jacobian[0] + normals[1] * jacobian[1]
    slopes = np.concatenate([by_point, se3.cross(rotated.T, by_point.T).T])
    blur = np.abs(blur_motion @ slopes)
    reach = np.minimum(np.maximum(REACH_PX, 0.75 * blur + 2), cell / 2)
    good = (cell > MIN_CELL_PX) & (patch.border_distance(pixels) > reach + 1) & (blur < cell)
    good &= model.to_end * length > END_CLEARANCE_PX
    found = np.flatnonzero(good)
    normals = normals.take(found, axis=1)
    return EdgeProfiles(
        model,
        found,
        pixels.T.take(found, axis=1).T,
        normals.T,
        slopes.take(found, axis=1).T,
        None if bends is None else (normals * bends.T.take(found, axis=1)).sum(axis=0),
        k1,
        reach[found],
        blur_motion,
        blur[found],
        readout_motion,
    )


def _at_their_rows(
    points: Array, rotated: Array, readout_motion: Array, projection: Projection
) -> Array:
    """Points where they are when the row is exposed in which they appear, (3, N) [m].

    `rotated` are their arms from the origin of the cube, (3, N).
    """
    way = readout_motion[:3, None] + np.cross(readout_motion[3:], rotated.T).T
    moved = points
    # Each time they are nearer to their row by the share of the image that they cross meanwhile.
    for _ in range(ROW_STEPS):
        rows = projection.project(moved.T)[:, 1]
        moved = points + way * row_shares(rows, projection.size[1])
    return np.asarray(moved, np.float64)


def row_shares(rows: Array, height: int) -> Array:
    """When rows of an image are exposed, as shares of the readout after the middle one, −0.5…0.5.

    >>> row_shares(np.array([-0.5, 239.5]), 480).tolist()
    [-0.5, 0.0]
    """
    return np.asarray((rows + 0.5) / height - 0.5, np.float64)


def measure_profiles(
    patch: Patch, profiles: EdgeProfiles, shifts: Array, width_px: float
) -> EdgeMeasurements:
    """Fit a blurred step to the image across each edge point.

    The model a + b·S(u/σ) − b·δ·s(u/σ)/σ, with S a smooth step and s its derivative, is linear in
    a, b and b·δ. Its parts are orthogonal after centring, so no iteration and no matrix is needed.
    Offsets count from profiles moved by `shifts` along their normals, (N,) [px]. `width_px` is the
    width of the step where the cube rests: a wide one finds edges that are farther off. What the
    widths of step and edge do to the offset is undone, so that one measurement is nearly enough.
    """
    taps = UNIT_TAPS * profiles.reach.astype(np.float32)
    normals = profiles.normals.T
    middles = profiles.pixels.T + shifts * normals - np.array([[patch.left], [patch.top]])
    (x, y), (across_x, across_y) = middles.astype(np.float32), normals.astype(np.float32)
    values = patch.sample_local(x + taps * across_x, y + taps * across_y)
    ramp = (RAMP_WIDTH * profiles.blur) ** 2
    width = np.minimum(np.sqrt(width_px**2 + ramp), MAX_WIDTH * profiles.reach).astype(np.float32)
    step = np.tanh(taps / width) / 2
    slope = (0.25 - step * step) * (2 / width)
    slope -= slope.sum(axis=0) / TAPS_PER_PROFILE
    contrast = _dot(step, values) / _dot(step, step)
    energy = _dot(slope, slope)
    safe = np.where(np.abs(contrast) > 1, contrast, 1)
    wider = width / np.sqrt(EDGE_WIDTH_PX**2 + ramp)
    gain = np.minimum(wider, wider**WIDE_EXPONENT)
    offset = -_dot(slope, values) / energy / safe
    offset *= (1 + GAIN_LOSS * (offset / width) ** 2) / gain
    # Two grey levels of noise; its true size follows from the residuals.
    variance = (4 / (safe * safe * energy) + MODEL_ERROR_PX**2) / (gain * gain)
    half = TAPS_PER_PROFILE // 2
    rise = (values[half + 1] - values[half - 1]).astype(np.float64)
    fitted = contrast * (step[half + 1] - step[half - 1])
    level = values.sum(axis=0, dtype=np.float64) / TAPS_PER_PROFILE
    return EdgeMeasurements(offset, contrast, level, 1 / variance, rise, fitted)


def _dot(a: Floats, b: Floats) -> Array:
    """Sum the products of columns, (M, N) and (M, N) → (N,)."""
    return np.asarray(np.einsum("ij,ij->j", a, b), np.float64)
