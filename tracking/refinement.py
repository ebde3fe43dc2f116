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
from tracking.faces import Faces
from tracking.patch import Patch
from tracking.profiles import Measured, Profiles, lay_out, offsets
from tracking.projection import Projection
from tracking.robust import quantile, tukey

Array = NDArray[np.float64]

GRAZING = 0.15
"""Cosine of the viewing angle below which the edges of a face are too foreshortened to help."""

BLOOM = 0.3
"""How far white may grow over black [px], one standard deviation: gamma, ink and overexposure."""

SWEPT_BLOOM = 0.15
"""The same for an edge that was swept, by each pixel of the sweep: gamma again."""

WIDE, PRECISE = 5.0, (2.0, 1.0)
"""Widths of the step that is fitted [px]: in the wide search, and first and last otherwise."""

FAINT = 0.4
"""An edge with less than this share of the contrast of good edges is covered, or none."""

FEWEST = 36
"""Fewer edge points than this do not make a pose."""

CLOSE = 0.7
"""Once no edge moves by more than this [px] the profiles need not be laid out anew."""

STEADY = 0.04
"""The profiles are measured again while edges move by more than this [px]."""

LAYOUTS = 3
"""So often they are laid out at most."""


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

    lines: int
    """Number of straight lines that they lie on."""

    inner: float
    """The same share for the edges inside the markers, which tell them apart."""

    shares: dict[str, float]
    """The same share for each face in view."""

    crisp: float
    """How steep the dullest edges are beside the steepest, both against what the sweep makes them;
    well below 1 where the cube moved in a way that was not told."""


@dataclass(frozen=True)
class _Fit:
    """The weighted least squares of one step."""

    measured: Measured
    """What all profiles show."""

    solution: Array
    """Shift-turn from the pose of the profiles, then the two blooms, (8,)."""

    strong: NDArray[np.intp]
    """Numbers of the profiles in which an edge was seen, (M,)."""

    rows: Array
    """Their linear equations, (M, 8)."""

    weights: Array
    """Information times robust weight, (M,)."""

    robust: Array
    """Robust weight, 0…1, (M,)."""

    residual: Array
    """What the solution leaves, (M,) [px]."""

    normal: Array
    """Normal matrix with its priors, (8, 8)."""


class EdgeRefiner:
    """Refines poses of one cube seen by one camera."""

    def __init__(self, cube: CubeModel, projection: Projection) -> None:
        self._faces = Faces(cube)
        self._model = EdgeModel.of(cube)
        self._projection = projection
        self._parts: dict[tuple[int, ...], EdgeModel] = {}

    def refine(
        self, patch: Patch, start: Array, sweep: Array | None = None, wide: bool = False
    ) -> Refinement | None:
        """Refine a pose that is right to about half a cell in the picture, or a whole one.

        Parameters
        ----------
        patch
            The picture round the cube.
        start
            Pose of the cube, (4, 4).
        sweep
            Shift-turn of the cube while the shutter was open, (6,); None for a cube at rest.
        wide
            Whether to begin with the outlines alone, which can be found from a whole cell away.

        Returns
        -------
        None where too few edges are in view or found, or where they do not agree.
        """
        current = start
        for _ in range(2 if wide else 0):
            profiles = self._profiles(patch, current, sweep, True)
            fit = _fit(patch, profiles, None, WIDE) if profiles else None
            if fit is None:
                return None
            current = se3.moved(current, fit.solution[:6])
        blurs = PRECISE
        for _ in range(LAYOUTS):
            profiles = self._profiles(patch, current, sweep, False)
            fit = _converged(patch, profiles, blurs) if profiles else None
            if profiles is None or fit is None:
                return None
            if np.abs(profiles.slopes @ fit.solution[:6]).max() < CLOSE:
                break
            current, blurs = se3.moved(current, fit.solution[:6]), PRECISE[1:]
        return self._judged(current, profiles, fit)

    def _profiles(
        self, patch: Patch, pose: Array, sweep: Array | None, wide: bool
    ) -> Profiles | None:
        facing = self._faces.facing(pose, GRAZING)
        if facing not in self._parts:
            self._parts[facing] = self._model.of_faces(facing)
        profiles = lay_out(self._parts[facing], self._projection, pose, patch, sweep, wide)
        return profiles if profiles and len(profiles.numbers) >= FEWEST else None

    def _judged(self, start: Array, profiles: Profiles, fit: _Fit) -> Refinement | None:
        kept = fit.strong[fit.robust > 0.1]
        if len(kept) < FEWEST:
            return None
        model = profiles.model
        numbers = profiles.numbers
        inner = ~model.outline[numbers]
        face = model.face[numbers]
        count = len(self._faces.names)
        wanted = np.bincount(face, minlength=count)
        found = np.bincount(face[kept], minlength=count)
        return Refinement(
            se3.moved(start, fit.solution[:6]),
            covariance(fit, model.line[numbers[fit.strong]], profiles.pixels[fit.strong]),
            float(np.sqrt((fit.robust * fit.residual**2).sum() / fit.robust.sum())),
            len(kept) / len(numbers),
            len(kept),
            len(np.unique(model.line[numbers[kept]])),
            float(np.count_nonzero(inner[kept])) / max(1, int(np.count_nonzero(inner))),
            {
                self._faces.names[number]: float(found[number] / wanted[number])
                for number in np.flatnonzero(wanted > 10).tolist()
            },
            _crisp(fit.measured, kept, model.line[numbers[kept]]),
        )


def _crisp(measured: Measured, kept: NDArray[np.intp], lines: NDArray[np.intp]) -> float:
    starts = np.flatnonzero(np.diff(lines, prepend=-1))
    rise = np.add.reduceat(measured.rise[kept], starts)
    fitted = np.add.reduceat(measured.fitted[kept], starts)
    steep = rise / np.maximum(fitted, 1e-9)
    return quantile(steep, 0.15) / max(quantile(steep, 0.85), 1e-9)


def _converged(patch: Patch, profiles: Profiles, blurs: tuple[float, ...]) -> _Fit | None:
    """Fit until the edges stay where they are: the profiles follow them, the geometry stays."""
    shifts = None
    for blur in (*blurs, *PRECISE[1:] * 2):
        fit = _fit(patch, profiles, shifts, blur)
        if fit is None:
            return None
        before, shifts = shifts, profiles.slopes @ fit.solution[:6]
        if before is not None and np.abs(shifts - before).max() < STEADY:
            break
    return fit


def _fit(patch: Patch, profiles: Profiles, shifts: Array | None, blur: float) -> _Fit | None:
    """Measure all profiles, and solve for the shift-turn and the blooms with robust weights."""
    measured = offsets(patch, profiles, 0.0 if shifts is None else shifts, blur)
    beside = measured.offset
    good = measured.contrast > _least_contrast(profiles.face, measured.contrast)
    good &= np.abs(beside) < profiles.reach
    strong = np.flatnonzero(good)
    if len(strong) < FEWEST:
        return None
    offset = (beside if shifts is None else beside + shifts)[strong]
    count = len(strong)
    rows = np.empty((count, 8))
    rows[:, :6] = profiles.slopes[strong]
    rows[:, 6] = 1
    rows[:, 7] = profiles.sweep[strong]
    information = measured.information[strong]
    weights, robust = information, np.ones(count)
    for _ in range(3):
        weighted = rows * weights[:, None]
        normal = weighted.T @ rows + PRIOR
        solution = np.linalg.solve(normal, weighted.T @ offset)
        residual = offset - rows @ solution
        scale = 1.4826 * quantile(np.abs(residual), 0.5)
        robust = tukey(residual, max(4.685 * scale, 0.1))
        weights = information * robust
    return _Fit(measured, solution, strong, rows, weights, robust, residual, normal)


PRIOR = np.diag([1e-3] * 6 + [1 / BLOOM**2, 1 / SWEPT_BLOOM**2])
"""Information of the priors of the blooms, and a trace of one that keeps the shift-turn solvable
when all is lost."""


def _least_contrast(face: NDArray[np.intp], contrast: Array) -> Array:
    """Contrast that an edge must have to be seen, by the other edges of its face, (N,)."""
    least = np.empty(len(face))
    overall = 3.0 + 0.1 * quantile(contrast, 0.7)
    starts = np.flatnonzero(np.diff(face, prepend=-1))
    for start, end in zip(starts, [*starts[1:], len(face)], strict=True):
        least[start:end] = max(overall, FAINT * quantile(contrast[start:end], 0.7))
    return least


def covariance(fit: _Fit, lines: NDArray[np.intp], pixels: Array) -> Array:
    """Covariance of the shift-turn, (6, 6), by what the residuals of each line have in common.

    The points of one straight line do not err independently: they share the paper, the light and
    their way of lying on the pixels. So each line, not each point, counts as one measurement
    (Liang and Zeger, 1986): normal⁻¹ (Σ s sᵀ) normal⁻¹, s the pull of all points of a line.

    Parameters
    ----------
    fit
        The last step.
    lines
        Number of the line of each profile of the fit, never falling, (M,).
    pixels
        Where it was seen, (M, 2) [px].
    """
    inverse = np.linalg.inv(fit.normal)
    starts = np.flatnonzero(np.diff(lines, prepend=-1))
    count = len(starts)
    weighted = fit.rows * fit.weights[:, None]
    pulls = np.add.reduceat(weighted * fit.residual[:, None], starts) @ inverse
    # The solution has taken seven numbers out of the residuals of so many lines.
    spread = pulls[:, :6].T @ pulls[:, :6] * (count / max(count - 7, 1))
    # Nothing is known better than as if all residuals were independent.
    chi = float((fit.weights * fit.residual**2).sum()) / max(1.0, float(fit.robust.sum()) - 7)
    return (
        spread
        + inverse[:6, :6] * max(chi, 0.05) * FEW_LINES
        + _shared(fit, inverse, starts, weighted, pixels)
    )


FEW_LINES = 0.5
SHARED_ERROR = 0.02


def _shared(fit, inverse, starts, weighted, pixels):
    phases = 2 * np.pi * pixels
    sums = np.add.reduceat(
        np.concatenate([np.cos(phases), np.sin(phases), weighted], axis=1), starts
    )
    sizes = np.diff(starts, append=len(pixels))
    alike = np.hypot(sums[:, :2], sums[:, 2:4]).max(axis=1) / sizes
    pulls = (alike[:, None] * sums[:, 4:]) @ inverse[:, :6] * SHARED_ERROR
    return pulls.T @ pulls
