"""Bundle adjustment of camera, plates and views.

Levenberg-Marquardt on the normal equations. Each view has seven unknowns of its own (pose and
bloom) besides the shared ones (nine of the camera, six of each plate). The views are eliminated one
by one (Schur complement; Triggs et al., 2000, section 6), so the system to solve has 15 to 45
unknowns, however many views there are.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from cubeling.tracking.calibration.model import BLOOM_SIGMA_PX, CalibrationModel
from cubeling.tracking.calibration.view import View
from cubeling.tracking.geometry.arrays import Array, Indices

MIN_SIGMA_PX = 0.02
"""Smallest standard deviation that is assumed for a row."""

MAX_ITERATIONS = 40
"""Maximum number of Levenberg-Marquardt steps."""

MIN_GAIN = 1e-6
"""The iteration ends when a step reduces the cost by less than this share of it."""


@dataclass(frozen=True)
class AdjustmentResult:
    """The best model and its uncertainty."""

    model: CalibrationModel
    """Intrinsics and the views' poses at the optimum."""

    covariance: Array
    """Covariance of the camera's nine parameters and the plates' steps, (9 + 6 P, 9 + 6 P); zero
    for parameters that are not free."""

    residual: float
    """Robust standard deviation of a row [px]."""

    view_residuals: Array
    """Root mean square of each view's rows, each at most 3 px, (V,)."""

    cost: float
    """The minimum: squared residuals in units of their standard deviations, priors included."""


def adjust(views: Sequence[View], model: CalibrationModel) -> AdjustmentResult:
    """Return the unknowns that fit the measurements best, from a first guess."""
    damping = 1e-3
    residuals = model.residuals(views)
    sigma = _robust_sigma(residuals, model)
    equations = _normal_equations(views, model, sigma)
    cost = _cost(residuals, model, sigma)
    for _ in range(MAX_ITERATIONS):
        moved = model.apply_step(*equations.solve(damping, model.free_parameters))
        new_residuals = moved.residuals(views)
        new_cost = _cost(new_residuals, moved, sigma)
        if new_cost > cost:
            damping *= 8
            if damping > 1e6:
                break
            continue
        gain = cost - new_cost
        model, residuals, damping = moved, new_residuals, max(1e-9, damping / 5)
        sigma = _robust_sigma(residuals, model)
        equations = _normal_equations(views, model, sigma)
        cost = _cost(residuals, model, sigma)
        if gain < MIN_GAIN * max(1.0, cost):
            break
    clipped = [np.minimum(np.abs(residual), 3.0) for residual in residuals]
    view_residuals = np.array([np.sqrt((part**2).mean()) for part in clipped])
    inflation = _correlation_inflation(views, residuals, sigma)
    equations = _normal_equations(views, model, sigma * np.sqrt(inflation))
    return AdjustmentResult(
        model, equations.covariance(model.free_parameters), sigma, view_residuals, cost
    )


def _robust_sigma(residuals: Sequence[Array], model: CalibrationModel) -> float:
    """Return the robust standard deviation of a row [px], corrected for degrees of freedom."""
    residual = np.concatenate(residuals)
    unknowns = 7 * len(residuals) + len(model.free_parameters)
    correction = len(residual) / max(len(residual) - unknowns, 0.25 * len(residual))
    sigma = 1.4826 * float(np.median(np.abs(residual))) * float(np.sqrt(correction))
    return max(MIN_SIGMA_PX, sigma)


def _cost(residuals: Sequence[Array], model: CalibrationModel, sigma: float) -> float:
    scaled = np.abs(np.concatenate(residuals)) / sigma
    cost = float(np.where(scaled < 2, scaled**2, 4 * scaled - 4).sum())
    return cost + float((model.blooms**2).sum()) / BLOOM_SIGMA_PX**2 + model.prior_cost


@dataclass(frozen=True)
class _NormalEquations:
    """Normal equations of the shared unknowns, those of each view, and their coupling."""

    normal: Array
    """Of the shared unknowns, (S, S)."""

    right: Array
    """Right side of the shared unknowns, (S,)."""

    own: Array
    """Of the unknowns of each view, (V, 7, 7)."""

    own_right: Array
    """Right side of the unknowns of each view, (V, 7)."""

    cross: Array
    """Between the unknowns of each view and the shared ones, (V, 7, S)."""

    def reduce(self, damping: float) -> tuple[Array, Array]:
        """Return the equations of the intrinsics alone: the Schur complement of the views."""
        normal, right = self.normal.copy(), self.right.copy()
        normal[np.diag_indices(len(normal))] *= 1 + damping
        sides = np.concatenate([self.cross, self.own_right[..., None]], axis=2)
        solved = self._solve_views(sides, damping)
        # A sum over views of products is one product of all their rows.
        cross, solved = self.cross.reshape(-1, len(right)), solved.reshape(-1, len(right) + 1)
        normal -= cross.T @ solved[:, :-1]
        right -= cross.T @ solved[:, -1]
        return normal, right

    def solve(self, damping: float, free: Indices) -> tuple[Array, Array]:
        """Return the step of the shared unknowns (S,) and that of each view (V, 7)."""
        normal, right = self.reduce(damping)
        step = np.zeros(len(right))
        step[free] = np.linalg.solve(normal[np.ix_(free, free)], right[free])
        left_over = self.own_right - self.cross @ step
        return step, self._solve_views(left_over[..., None], damping)[..., 0]

    def _solve_views(self, right: Array, damping: float) -> Array:
        """Solve the damped equations of each view for its right sides, (V, 7, n)."""
        damped, diagonal = self.own.copy(), np.arange(self.own.shape[1])
        damped[:, diagonal, diagonal] *= 1 + damping
        return np.asarray(np.linalg.solve(damped, right))

    def covariance(self, free: Indices) -> Array:
        """Return the covariance of the shared unknowns; zero for those that are not free."""
        normal, _ = self.reduce(0.0)
        covariance = np.zeros_like(normal)
        covariance[np.ix_(free, free)] = np.linalg.inv(normal[np.ix_(free, free)])
        return covariance


def _normal_equations(
    views: Sequence[View], model: CalibrationModel, sigma: float
) -> _NormalEquations:
    count = 9 + 6 * len(model.plates)
    residual, by_camera, by_plate, by_view = model.linearise(views)
    rows = np.zeros((len(residual), count))
    rows[:, :9] = by_camera
    plates = np.concatenate([view.plates for view in views])
    np.put_along_axis(rows, 9 + 6 * plates[:, None] + np.arange(6), by_plate, axis=1)
    # Huber weights limit the pull of a row to that of a residual of two sigma.
    weights = 1 / np.maximum(1.0, np.abs(residual) / (2 * sigma)) / sigma**2
    weighted = rows * weights[:, None]
    normal, right = rows.T @ weighted, weighted.T @ residual
    own = np.zeros((len(views), 7, 7))
    own_right, cross = np.zeros((len(views), 7)), np.zeros((len(views), 7, count))
    ends = np.cumsum([len(view.points) for view in views])
    for number, end in enumerate(ends.tolist()):
        at = slice(end - len(views[number].points), end)
        by_own = by_view[at].T
        own[number] = (by_own * weights[at]) @ by_own.T
        own_right[number] = (by_own * weights[at]) @ residual[at]
        cross[number] = by_own @ weighted[at]
    own[:, 6, 6] += 1 / BLOOM_SIGMA_PX**2
    own_right[:, 6] -= model.blooms / BLOOM_SIGMA_PX**2
    model.add_priors(normal, right)
    return _NormalEquations(normal, right, own, own_right, cross)


def _correlation_inflation(
    views: Sequence[View], residuals: Sequence[Array], sigma: float
) -> float:
    """Return by how much the variance of an edge's mean exceeds that of independent rows, ≥ 1.

    The rows of one edge share pixels, light and errors of the model.
    """
    correlated = independent = 0.0
    for view, residual in zip(views, residuals, strict=True):
        clipped = np.clip(residual, -3 * sigma, 3 * sigma)
        sums = np.bincount(view.lines, weights=clipped)
        correlated += float((sums**2).sum())
        independent += float((clipped**2).sum())
    return max(1.0, correlated / max(independent, 1e-12))
