"""One robust least-squares step on the edges of the cube, and its covariance."""

from dataclasses import dataclass, replace

import cv2
import numpy as np

from cubeling.tracking.geometry.arrays import Array, Flags, Indices, run_starts
from cubeling.tracking.geometry.image_region import Patch
from cubeling.tracking.geometry.robust_statistics import quantile, robust_weight
from cubeling.tracking.refinement.edges.profiles import (
    EdgeMeasurements,
    EdgeProfiles,
    measure_profiles,
)
from cubeling.tracking.refinement.systematic_error import CLAIMED_K1

BLOOM_PX, BLOOM_PER_BLUR = 0.3, 0.15
"""How far white grows over black, one standard deviation: gamma, ink and overexposure; and more for
each pixel of blur: gamma again."""

PRIOR_INFORMATION = np.diag(
    [1e-3] * 6 + [1 / BLOOM_PX**2, 1 / BLOOM_PER_BLUR**2, 1 / CLAIMED_K1**2]
)
"""Information of the priors of the blooms and of k1, and a little that keeps the pose delta
solvable."""

MIN_CONTRAST_SHARE = 0.4
"""An edge with less than this share of the contrast of good edges is covered, or is no edge."""

MIN_CONTRAST, DEEPEST_SHADOW = 3.0, 0.1
"""Contrast that noise alone can show [grey levels], and contrast in the deepest shadow as a share
of that of good edges."""

MIN_EDGE_POINTS = 36
"""Fewer edge points than this do not determine a pose."""

MIN_OUTLIER_PX = 0.1
"""An edge that is off by less than this is no outlier."""

INDEPENDENT_SHARE = 0.5
"""Share of the covariance of independent residuals to add: a few lines show too little spread."""

PIXEL_PHASE_ERROR_PX = 0.02
"""Error that all points of a line have in common if they lie alike on the pixel grid."""

DOUBTFUL_DEVIATIONS = 1.5
"""A k1 that differs from none by less than so many standard deviations may be noise."""


@dataclass(frozen=True)
class EdgeFit:
    """One weighted least-squares step."""

    measured: EdgeMeasurements
    """Measurements of all profiles."""

    solution: Array
    """Changes from the profiles: pose delta, the two blooms, and k1 where it is unknown, (K,)."""

    strong: Indices
    """Numbers of the profiles in which an edge was seen, (M,)."""

    rows: Array
    """Their linear equations, (M, K)."""

    weights: Array
    """Information times robust weight, (M,)."""

    robust: Array
    """Robust weight, 0…1, (M,)."""

    residual: Array
    """Residuals of the solution, (M,) [px]."""

    normal: Array
    """Normal matrix with its priors, (K, K)."""


@dataclass(frozen=True)
class FittedEdges:
    """The last step of a refinement, for what else its residuals tell."""

    profiles: EdgeProfiles
    """Where the edges were measured."""

    fit: EdgeFit
    """What was found there."""

    @property
    def k1(self) -> float:
        """Radial distortion beyond that of the intrinsics, as far as this image tells it."""
        return self.profiles.k1 + float(self.fit.solution[8:].sum())

    @property
    def residual_without_k1(self) -> Array:
        """Residuals of the same pose through the lens that the intrinsics claim, (M,) [px]."""
        if self.profiles.bends is None:
            return self.fit.residual
        return self.fit.residual + self.profiles.bends[self.fit.strong] * self.k1


def fit_edges(
    patch: Patch, profiles: EdgeProfiles, shifts: Array, width_px: float, steps: int = 3
) -> EdgeFit | None:
    """Measure all profiles, and solve for pose delta, blooms and k1 with robust weights.

    `shifts` is how far along their normals the edges have moved since the profiles were placed,
    (N,) [px], `width_px` as in `measure_profiles`, `steps` how often the weights are found. None
    where too few edges are visible.
    """
    measured = measure_profiles(patch, profiles, shifts, width_px)
    good = _is_printed(profiles, measured)
    # An offset at the end of the profile says only that the edge is somewhere beyond it.
    good &= np.abs(measured.offset) < profiles.reach
    strong = np.flatnonzero(good)
    if len(strong) < MIN_EDGE_POINTS:
        return None
    offset = (measured.offset + shifts)[strong]
    columns = profiles.equations.take(strong, axis=1)
    unknowns = len(columns)
    prior, pull = PRIOR_INFORMATION[:unknowns, :unknowns], np.zeros(unknowns)
    if profiles.bends is not None:
        # The unknown is a change of k1; its prior is about k1 itself, so it pulls the sum to zero.
        pull[8] = -prior[8, 8] * profiles.k1
    information = measured.information[strong]
    weights, robust = information, np.ones(len(strong))
    for _ in range(steps):
        weighted = columns * weights
        normal = np.asarray(weighted @ columns.T + prior, np.float64)
        right = (weighted @ offset + pull)[:, None]
        # In half the time that numpy takes for so few unknowns.
        _, solved = cv2.solve(normal, right, flags=cv2.DECOMP_CHOLESKY)
        solution = np.asarray(solved, np.float64)[:, 0]
        residual = np.asarray(offset - solution @ columns, np.float64)
        robust = robust_weight(residual, MIN_OUTLIER_PX)
        weights = information * robust
    return EdgeFit(measured, solution, strong, columns.T, weights, robust, residual, normal)


def _is_printed(profiles: EdgeProfiles, measured: EdgeMeasurements) -> Flags:
    """Whether each edge has as much contrast as the other edges of its face, (N,).

    In a shadow, ink keeps its Weber contrast, relative to the local light; skin has little of it.
    """
    weber = measured.contrast / np.maximum(measured.level, 1.0)
    least = np.empty(len(weber))
    for run in profiles.face_runs:
        least[run] = MIN_CONTRAST_SHARE * quantile(weber[run], 0.7)
    overall = MIN_CONTRAST + DEEPEST_SHADOW * quantile(measured.contrast, 0.7)
    return np.asarray((weber > least) & (measured.contrast > overall), np.bool_)


def covariance(fit: EdgeFit, lines: Indices, pixels: Array) -> Array:
    """Covariance of the solution, (K, K), with each straight line as one measurement.

    The points of a line share paper, light and their phase on the pixel grid. So this is the
    sandwich estimator for clusters (Liang and Zeger, 1986): normal⁻¹ (Σ s sᵀ) normal⁻¹, with s the
    sum of the scores of one line. `lines` is the index of the line of each profile of the fit,
    ascending, (M,), and `pixels` its position, (M, 2) [px].
    """
    inverse = np.asarray(np.linalg.inv(fit.normal), np.float64)
    starts = run_starts(lines)
    count = len(starts)
    weighted = fit.rows * fit.weights[:, None]
    scores = np.add.reduceat(weighted * fit.residual[:, None], starts) @ inverse
    # The solution has used up seven degrees of freedom.
    spread = scores.T @ scores * (count / max(count - 7, 1))
    # Reduced chi square of independent residuals.
    chi = float((fit.weights * fit.residual**2).sum()) / max(1.0, float(fit.robust.sum()) - 7)
    return np.asarray(
        spread
        + inverse * max(chi, 0.05) * INDEPENDENT_SHARE
        + _phase_covariance(inverse, starts, weighted, pixels),
        np.float64,
    )


def without_doubtful_k1(fit: EdgeFit, placed_k1: float, variance: float) -> EdgeFit:
    """Take out of a fit what of its k1, with a variance, may be noise, and let the pose follow.

    An unknown k1 makes distances several times less exact, and most lenses that are drawn or that
    were rectified have none. So it counts as far as it stands out (Breiman, 1995, "Better subset
    regression using the nonnegative garrote"). `placed_k1` is that of the profiles.
    """
    k1 = placed_k1 + float(fit.solution[8])
    doubt = min(DOUBTFUL_DEVIATIONS**2 * variance / max(k1**2, 1e-12), 1.0)
    unit = np.zeros((len(fit.solution), 1))
    unit[8] = 1.0
    # How the other unknowns follow k1, which the edges leave free to move with it.
    along = np.asarray(cv2.solve(fit.normal, unit, flags=cv2.DECOMP_CHOLESKY)[1])[:, 0]
    change = -doubt * k1 * along / along[8]
    residual = np.asarray(fit.residual - fit.rows @ change, np.float64)
    return replace(fit, solution=fit.solution + change, residual=residual)


def _phase_covariance(inverse: Array, starts: Indices, weighted: Array, pixels: Array) -> Array:
    """Covariance of the errors that come from the phase of a line on the pixel grid, (K, K).

    The points of a line along the rows or columns of pixels are off together by a few hundredths of
    a pixel, which residuals do not show; along a slanted line that averages out.
    """
    phases = 2 * np.pi * pixels
    columns = np.concatenate([np.cos(phases), np.sin(phases), weighted], axis=1)
    sums = np.add.reduceat(columns, starts)
    sizes = np.diff(starts, append=len(pixels))
    alike = np.hypot(sums[:, :2], sums[:, 2:4]).max(axis=1) / sizes
    scores = (alike[:, None] * sums[:, 4:]) @ inverse * PIXEL_PHASE_ERROR_PX
    return np.asarray(scores.T @ scores, np.float64)
