"""One least-squares step on the edges of the cube, with robust weights, and what it is worth."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tracking.geometry.image_region import Patch
from tracking.geometry.robust_statistics import quantile, tukey
from tracking.refinement.profiles import EdgeMeasurements, EdgeProfiles, offsets

Array = NDArray[np.float64]

BLOOM = 0.3
"""How far white may grow over black [px], one standard deviation: gamma, ink and overexposure."""

SWEPT_BLOOM = 0.15
"""The same for an edge that was swept, by each pixel of the sweep: gamma again."""

PRIOR = np.diag([1e-3] * 6 + [1 / BLOOM**2, 1 / SWEPT_BLOOM**2])
"""Information of the priors of the blooms, and a trace of one that keeps the shift-turn solvable
when all is lost."""

FAINT = 0.4
"""An edge with less than this share of the contrast of good edges is covered, or none."""

NOISE, DARKEST = 3.0, 0.1
"""Contrast that noise alone can show [grey levels], and the deepest shadow, beside good edges."""

FEWEST = 36
"""Fewer edge points than this do not make a pose."""

FEW_LINES = 0.5
"""Share of the variance that independent residuals would give, which is added: a few lines tell
little of their own spread."""

SHARED_ERROR = 0.02
"""Error that all points of a line have in common if they lie alike on the pixels [px]."""


@dataclass(frozen=True)
class EdgeFit:
    """The weighted least squares of one step."""

    measured: EdgeMeasurements
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


def fit(
    patch: Patch, profiles: EdgeProfiles, shifts: Array | None, blur: float
) -> "EdgeFit | None":
    """Measure all profiles, and solve for the shift-turn and the blooms with robust weights.

    Parameters
    ----------
    patch
        The picture.
    profiles
        Where to look.
    shifts
        How far along their normals the edges have moved since the profiles were laid out, (N,)
        [px]; None for not at all.
    blur
        Width of a step at rest [px].

    Returns
    -------
    None where too few edges are seen.
    """
    measured = offsets(patch, profiles, 0.0 if shifts is None else shifts, blur)
    beside = measured.offset
    good = _printed(profiles.face, measured)
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
    for _ in range(2 if shifts is None else 3):
        weighted = rows * weights[:, None]
        normal = np.asarray(weighted.T @ rows + PRIOR, np.float64)
        solution = np.asarray(np.linalg.solve(normal, weighted.T @ offset), np.float64)
        residual = np.asarray(offset - rows @ solution, np.float64)
        scale = 1.4826 * quantile(np.abs(residual), 0.5)
        robust = tukey(residual, max(4.685 * scale, 0.1))
        weights = information * robust
    weights = np.asarray(information * robust, np.float64)
    return EdgeFit(measured, solution, strong, rows, weights, robust, residual, normal)


def _printed(face: NDArray[np.intp], measured: EdgeMeasurements) -> NDArray[np.bool_]:
    """Whether an edge is as clear as the other edges of its face are, (N,).

    Contrast is taken beside the light there (Weber's): ink on paper keeps it in a shadow, where
    plain contrast falls; skin has little of it anywhere.
    """
    clear = measured.contrast / np.maximum(measured.level, 1.0)
    least = np.empty(len(face))
    starts = np.flatnonzero(np.diff(face, prepend=-1))
    for start, end in zip(starts, [*starts[1:], len(face)], strict=True):
        least[start:end] = FAINT * quantile(clear[start:end], 0.7)
    overall = NOISE + DARKEST * quantile(measured.contrast, 0.7)
    return np.asarray((clear > least) & (measured.contrast > overall), np.bool_)


def covariance(fit: EdgeFit, lines: NDArray[np.intp], pixels: Array) -> Array:
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
    inverse = np.asarray(np.linalg.inv(fit.normal), np.float64)
    starts = np.flatnonzero(np.diff(lines, prepend=-1))
    count = len(starts)
    weighted = fit.rows * fit.weights[:, None]
    pulls = np.add.reduceat(weighted * fit.residual[:, None], starts) @ inverse
    # The solution has taken seven numbers out of the residuals of so many lines.
    spread = pulls[:, :6].T @ pulls[:, :6] * (count / max(count - 7, 1))
    # Nothing is known better than as if all residuals were independent.
    chi = float((fit.weights * fit.residual**2).sum()) / max(1.0, float(fit.robust.sum()) - 7)
    return np.asarray(
        spread
        + inverse[:6, :6] * max(chi, 0.05) * FEW_LINES
        + _shared(inverse, starts, weighted, pixels),
        np.float64,
    )


def _shared(inverse: Array, starts: NDArray[np.intp], weighted: Array, pixels: Array) -> Array:
    """Covariance of what all points of a line err by alike, (6, 6).

    At the true pose all points of a line that runs with the rows or columns of pixels are off
    together, by a few hundredths of a pixel; along a slanted line that averages out. The residuals
    do not show it where the pose can take it up.
    """
    phases = 2 * np.pi * pixels
    columns = np.concatenate([np.cos(phases), np.sin(phases), weighted], axis=1)
    sums = np.add.reduceat(columns, starts)
    sizes = np.diff(starts, append=len(pixels))
    alike = np.hypot(sums[:, :2], sums[:, 2:4]).max(axis=1) / sizes
    pulls = (alike[:, None] * sums[:, 4:]) @ inverse[:, :6] * SHARED_ERROR
    return np.asarray(pulls.T @ pulls, np.float64)
