"""Gauss-Newton on the edges of all visible markers: from a good pose to the best one.

Where the model says that an edge runs, the picture is sampled across it. A blurred step is fitted
to each such profile, which tells how far the edge lies from its place to a few hundredths of a
pixel; a shift-turn that takes all edges home together is the correction. The idea is RAPiD's
(Harris and Stennett, 1990); the profile fit, the bloom and the covariance are ours.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tracking import se3
from tracking.cube import CubeModel
from tracking.edges import EdgeModel
from tracking.projection import Projection
from tracking.solver import NEAREST

Array = NDArray[np.float64]

GRAZING = 0.15
"""Cosine of the viewing angle below which the edges of a face are too foreshortened to help."""

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

BLOOM = 0.3
"""How far white may grow over black [px], one standard deviation: gamma, ink and overexposure."""

MODEL_ERROR = 0.04
"""Error of a single edge place that does not come from noise [px]: neighbouring cells, sampling."""

SHARED_ERROR = 0.025
"""The part of it that all points of a line have in common if they lie alike on the pixels [px]."""

WIDE, PRECISE = 5.0, (2.0, 1.0, 1.0)
"""Widths of the step that is fitted [px] in the wide search, and in the steps of Gauss-Newton."""

FAINT = 0.4
"""An edge with less than this share of the contrast of good edges is covered, or none."""

FEWEST = 40
"""Fewer edge points than this do not make a pose."""

OPTIMISM = 1.2
"""Variances are raised by this: neighbouring profiles share their pixels and their model errors.
Measured as the coverage that `python -m tests.bench.accuracy` prints."""


@dataclass(frozen=True)
class Refinement:
    """A pose that rests on edges."""

    camera_from_cube: Array
    """Pose of the cube, (4, 4) [m]."""

    covariance: Array
    """Of a shift-turn, (6, 6)."""

    residual: float
    """Weighted root mean square distance of the edges from their places [px]."""

    support: float
    """Share of the edge points in view that were found, 0…1."""

    points: int
    """Number of edge points found."""

    inner: float
    """The same for the edges inside the markers, which tell them apart."""

    shares: dict[str, float]
    """The same for each face in view."""


@dataclass(frozen=True)
class _Profiles:
    """Edge points in view, and the straight lines in the picture that cross them."""

    numbers: NDArray[np.intp]
    pixels: Array
    normals: Array
    slopes: Array
    reach: Array


class EdgeRefiner:
    """Refines poses of one cube seen by one camera."""

    def __init__(self, cube: CubeModel, projection: Projection) -> None:
        self._names = tuple(face.name for face in cube.faces)
        self._model = EdgeModel.of(cube)
        self._projection = projection

    def refine(
        self, grey: NDArray[np.uint8], start: Array, wide: bool = False
    ) -> Refinement | None:
        """Refine a pose that is right to about half a cell in the picture, or a whole one.

        Parameters
        ----------
        grey
            The picture, (H, W).
        start
            Pose of the cube, (4, 4).
        wide
            Whether to begin with the outlines alone, which can be found from a whole cell away.

        Returns
        -------
        None where too few edges are in view or found, or where they do not agree.
        """
        current = start
        result = None
        for blur in (WIDE, WIDE, *PRECISE) if wide else PRECISE:
            profiles = self._profiles(current, grey.shape, blur == WIDE)
            if len(profiles.numbers) < FEWEST:
                return None
            result = self._step(grey, current, profiles, blur)
            if result is None:
                return None
            moved = se3.motion(current, result.camera_from_cube)
            current = result.camera_from_cube
            if blur == PRECISE[-1] and (moved**2 < np.diag(result.covariance) / 25).all():
                break
        return result

    def _profiles(self, camera_from_cube: Array, shape: tuple[int, ...], wide: bool) -> _Profiles:
        model = self._model
        turn, origin = camera_from_cube[:3, :3], camera_from_cube[:3, 3]
        sights = model.centres @ turn.T + origin
        cosines = -np.einsum("ij,ij->i", model.normals @ turn.T, sights)
        facing = cosines > GRAZING * np.linalg.norm(sights, axis=1)
        numbers = np.flatnonzero(facing[model.face] & (model.outline | (not wide)))
        turned = model.points[numbers] @ turn.T
        points = turned + origin
        if not len(points) or points[:, 2].min() < NEAREST:
            return _Profiles(np.zeros(0, np.intp), *(np.zeros((0, n)) for n in (2, 2, 6, 1)))
        pixels, slopes = self._projection.pixels_and_slopes(points)
        along = np.einsum("nij,nj->ni", slopes, model.along[numbers] @ turn.T)
        across = np.einsum("nij,nj->ni", slopes, model.across[numbers] @ turn.T)
        length = np.linalg.norm(along, axis=1)
        normals = np.stack([-along[:, 1], along[:, 0]], axis=1) / length[:, None]
        cell = np.einsum("ni,ni->n", normals, across)
        normals *= np.sign(cell)[:, None]
        cell = np.abs(cell)
        height, width = shape
        room = np.minimum(pixels, (width - 1, height - 1) - pixels).min(axis=1)
        reach = np.minimum(REACH, cell / 2)
        if wide:
            reach = np.minimum(WIDE_REACH[0], cell * WIDE_REACH[1])
        good = (cell > NARROWEST) & (room > reach + 1)
        good &= model.to_end[numbers] * length > END_CLEARANCE
        by_point = np.einsum("ni,nij->nj", normals, slopes)
        rows = np.concatenate([by_point, np.cross(turned, by_point)], axis=1)
        return _Profiles(numbers[good], pixels[good], normals[good], rows[good], reach[good])

    def _step(
        self, grey: NDArray[np.uint8], current: Array, profiles: _Profiles, blur: float
    ) -> Refinement | None:
        offset, contrast, information = edge_offsets(grey, profiles, blur)
        strong = contrast > max(8.0, FAINT * _quantile(contrast, 0.7))
        strong &= np.abs(offset) < profiles.reach
        if np.count_nonzero(strong) < FEWEST:
            return None
        rows = np.concatenate([profiles.slopes, np.ones((len(offset), 1))], axis=1)[strong]
        offset, information = offset[strong], information[strong]
        weights = information
        for _ in range(4):
            solution, normal = _weighted(rows, offset, weights)
            residual = offset - rows @ solution
            scale = 1.4826 * _quantile(np.abs(residual), 0.5)
            robust = _tukey(residual, max(4.685 * scale, 0.1))
            weights = information * robust
        kept = robust > 0.1
        used = int(np.count_nonzero(kept))
        if used < FEWEST:
            return None
        chi = float((weights * residual**2).sum()) / max(1.0, float(robust.sum()) - 7)
        inverse = np.linalg.inv(normal)
        found = profiles.numbers[strong]
        scores = self._shared_scores(rows * weights[:, None], profiles.pixels[strong], found)
        shared = (scores @ inverse)[:, :6] * SHARED_ERROR
        support = used / len(profiles.numbers)
        # What covers some edges, a finger and its shadow, disturbs those that it leaves.
        covariance = inverse[:6, :6] * (max(chi, 0.25) * OPTIMISM / support**2) + shared.T @ shared
        spread = float(np.sqrt((robust * residual**2).sum() / robust.sum()))
        found = found[kept]
        return Refinement(
            se3.moved(current, solution[:6]),
            (covariance + covariance.T) / 2,
            spread,
            support,
            used,
            self._inner(profiles, found),
            self._shares(profiles, found),
        )

    def _shared_scores(self, weighted: Array, pixels: Array, numbers: NDArray[np.intp]) -> Array:
        """Pull of each line whose points all err alike, (lines, 7).

        Measured at the true pose, all points of a line that runs with the rows or columns of pixels
        are off together, by up to 0.04 px; along a slanted line they average out. The likely cause
        is where an edge lies between two pixels, but that is not proved. The residuals do not show
        it where the pose can take it up, so it is counted here.
        """
        lines = self._model.line[numbers]
        on_line = (lines == np.unique(lines)[:, None]).astype(np.float64)
        phases = 2 * np.pi * pixels
        means = np.hypot(on_line @ np.cos(phases), on_line @ np.sin(phases))
        alike = means.max(axis=1, keepdims=True) / on_line.sum(axis=1, keepdims=True)
        return np.asarray(alike * (on_line @ weighted), np.float64)

    def _inner(self, profiles: _Profiles, found: NDArray[np.intp]) -> float:
        wanted = int(np.count_nonzero(~self._model.outline[profiles.numbers]))
        return float(np.count_nonzero(~self._model.outline[found])) / max(1, wanted)

    def _shares(self, profiles: _Profiles, found: NDArray[np.intp]) -> dict[str, float]:
        counts = np.bincount(self._model.face[found], minlength=len(self._names))
        wanted = np.bincount(self._model.face[profiles.numbers], minlength=len(self._names))
        in_view = np.flatnonzero(wanted > 10).tolist()
        return {self._names[face]: float(counts[face] / wanted[face]) for face in in_view}


def edge_offsets(
    grey: NDArray[np.uint8], profiles: _Profiles, blur: float
) -> tuple[Array, Array, Array]:
    """Fit a blurred step to the picture across each edge point.

    The model a + b·S(u/σ) − b·δ·s(u/σ)/σ, (S a smooth step, s its slope), is linear in a, b and
    b·δ, and its parts are orthogonal after centring: no iteration, no matrix.

    Returns
    -------
    Offset of the edge along the normal [px], contrast b [grey levels], and the information about
    the offset [1/px²], each (N,).
    """
    taps = np.linspace(-1, 1, TAPS)[None] * profiles.reach[:, None]
    places = profiles.pixels[:, None] + taps[..., None] * profiles.normals[:, None]
    values = bilinear(grey, places)
    width = np.minimum(blur, profiles.reach * 0.45)[:, None]
    step = np.tanh(taps / width) / 2
    slope = (0.25 - step**2) * 2 / width
    slope -= slope.mean(axis=1, keepdims=True)
    contrast = (step * values).sum(axis=1) / (step**2).sum(axis=1)
    energy = (slope**2).sum(axis=1)
    shifted = -(slope * values).sum(axis=1) / energy
    safe = np.where(np.abs(contrast) > 1, contrast, 1)
    # Two grey levels of noise; its true size is found from the residuals.
    variance = 4 / (safe**2 * energy) + MODEL_ERROR**2
    return shifted / safe, contrast, 1 / variance


def bilinear(grey: NDArray[np.uint8], places: Array) -> Array:
    """Grey values between pixel centres, places (…, 2) inside the picture → (…,).

    OpenCV's `remap` rounds places to 1/32 px, which is coarser than what is measured here.
    """
    width = grey.shape[1]
    corner = places.astype(np.intp)
    fraction = places - corner
    x, y = fraction[..., 0], fraction[..., 1]
    index = corner[..., 1] * width + corner[..., 0]
    flat = grey.reshape(-1)
    upper = flat[index] * (1 - x) + flat[index + 1] * x
    lower = flat[index + width] * (1 - x) + flat[index + width + 1] * x
    return np.asarray(upper * (1 - y) + lower * y, np.float64)


def _quantile(values: Array, share: float) -> float:
    """Return the value below which a share of all lies; eight times faster than `np.quantile`."""
    place = int(share * (len(values) - 1))
    return float(np.partition(values, place)[place])


def _tukey(residual: Array, cut: float) -> Array:
    """Tukey's biweight: 1 at zero, 0 from `cut` on."""
    return np.square(np.clip(1 - (residual / cut) ** 2, 0, None))


def _weighted(rows: Array, offset: Array, weights: Array) -> tuple[Array, Array]:
    """Solve for the shift-turn and the bloom, (7,), with the normal matrix, (7, 7)."""
    weighted = rows * weights[:, None]
    normal = weighted.T @ rows
    # The prior of the bloom, and a trace of one that keeps the shift-turn solvable when all is
    # lost.
    normal += np.diag([1e-3] * 6 + [1 / BLOOM**2])
    return np.asarray(np.linalg.solve(normal, weighted.T @ offset), np.float64), normal
