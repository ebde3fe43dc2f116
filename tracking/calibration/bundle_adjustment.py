"""Bundle adjustment of camera, plates and views.

Levenberg-Marquardt on the normal equations. Each view has seven unknowns of its own (pose and
bloom) besides the shared ones (nine of the camera, six of each plate). The views are eliminated one
by one (Schur complement; Triggs et al., 2000, section 6), so the system to solve has 15 to 45
unknowns, however many views there are.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tracking.calibration.model import (
    BLOOM_SIGMA_PX,
    CalibrationModel,
    CalibrationTarget,
    add_priors,
    apply_step,
    free_parameters,
    linearise,
    prior_cost,
    residuals,
)
from tracking.calibration.view import View

Array = NDArray[np.float64]

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
    """The unknowns."""

    covariance: Array
    """Covariance of the camera's nine parameters and the plates' steps, (9 + 6 P, 9 + 6 P); zero
    for parameters that are not free."""

    residual: float
    """Robust standard deviation of a row [px]."""

    view_residuals: Array
    """Root mean square of each view's rows, each at most 3 px, (V,)."""

    cost: float
    """The minimum: squared residuals in units of their standard deviations, priors included."""


def adjust(
    views: Sequence[View], start: CalibrationModel, target: CalibrationTarget
) -> AdjustmentResult:
    """Return the unknowns that fit the measurements best, from a first guess."""
    model, damping = start, 1e-3
    sigma = _robust_sigma(views, model, target)
    shared, blocks = _normal_equations(views, model, target, sigma)
    cost = _cost(views, model, target, sigma)
    for _ in range(MAX_ITERATIONS):
        moved = apply_step(model, target, *_solve(shared, blocks, damping, target))
        new_cost = _cost(views, moved, target, sigma)
        if new_cost > cost:
            damping *= 8
            if damping > 1e6:
                break
            continue
        gain = cost - new_cost
        model, damping = moved, max(1e-9, damping / 5)
        sigma = _robust_sigma(views, model, target)
        shared, blocks = _normal_equations(views, model, target, sigma)
        cost = _cost(views, model, target, sigma)
        if gain < MIN_GAIN * max(1.0, cost):
            break
    return _result(views, model, target, sigma, cost)


def _all_residuals(
    views: Sequence[View], model: CalibrationModel, target: CalibrationTarget
) -> list[Array]:
    return [residuals(view, model, number, target) for number, view in enumerate(views)]


def _huber_weights(residual: Array, sigma: float) -> Array:
    """Return weights that limit the pull of a row to that of a residual of two sigma."""
    return np.asarray(1 / np.maximum(1.0, np.abs(residual) / (2 * sigma)), np.float64)


def _robust_sigma(
    views: Sequence[View], model: CalibrationModel, target: CalibrationTarget
) -> float:
    """Return the robust standard deviation of a row [px], corrected for degrees of freedom."""
    residual = np.concatenate(_all_residuals(views, model, target))
    unknowns = 7 * len(views) + len(free_parameters(target))
    correction = len(residual) / max(len(residual) - unknowns, 0.25 * len(residual))
    sigma = 1.4826 * float(np.median(np.abs(residual))) * float(np.sqrt(correction))
    return max(MIN_SIGMA_PX, sigma)


def _cost(
    views: Sequence[View], model: CalibrationModel, target: CalibrationTarget, sigma: float
) -> float:
    total = 0.0
    for residual in _all_residuals(views, model, target):
        scaled = np.abs(residual) / sigma
        total += float(np.where(scaled < 2, scaled**2, 4 * scaled - 4).sum())
    return total + float((model.blooms**2).sum()) / BLOOM_SIGMA_PX**2 + prior_cost(model, target)


NormalEquations = tuple[Array, Array]
"""Normal matrix and right side."""


@dataclass(frozen=True)
class _ViewBlock:
    """The normal equations of one view's own unknowns."""

    normal: Array
    """(7, 7)."""

    right: Array
    """(7,)."""

    cross: Array
    """Coupling to the shared unknowns, (7, 9 + 6 P)."""

    def solve(self, right: Array, damping: float) -> Array:
        """Solve the damped equations for one or several right sides."""
        damped = self.normal + damping * np.diag(np.diag(self.normal))
        return np.asarray(np.linalg.solve(damped, right))


def _normal_equations(
    views: Sequence[View], model: CalibrationModel, target: CalibrationTarget, sigma: float
) -> tuple[NormalEquations, list[_ViewBlock]]:
    count = 9 + 6 * len(model.plates)
    normal, right, blocks = np.zeros((count, count)), np.zeros(count), []
    for number, view in enumerate(views):
        residual, by_camera, by_plate, by_view = linearise(view, model, number, target)
        rows = np.zeros((len(residual), count))
        rows[:, :9] = by_camera
        columns = 9 + 6 * view.plates[:, None] + np.arange(6)
        np.put_along_axis(rows, columns, by_plate, axis=1)
        weights = _huber_weights(residual, sigma)[:, None] / sigma**2
        normal += rows.T @ (rows * weights)
        right += (rows * weights).T @ residual
        own_normal = by_view.T @ (by_view * weights)
        own_right = (by_view * weights).T @ residual
        own_normal[6, 6] += 1 / BLOOM_SIGMA_PX**2
        own_right[6] -= model.blooms[number] / BLOOM_SIGMA_PX**2
        blocks.append(_ViewBlock(own_normal, own_right, by_view.T @ (rows * weights)))
    add_priors(normal, right, model, target)
    return (normal, right), blocks


def _reduce(
    shared: NormalEquations, blocks: Sequence[_ViewBlock], damping: float
) -> NormalEquations:
    """Eliminate the views."""
    normal, right = shared[0].copy(), shared[1].copy()
    normal[np.diag_indices(len(normal))] *= 1 + damping
    for block in blocks:
        solved = block.solve(np.column_stack([block.cross, block.right]), damping)
        normal -= block.cross.T @ solved[:, :-1]
        right -= block.cross.T @ solved[:, -1]
    return normal, right


def _solve(
    shared: NormalEquations,
    blocks: Sequence[_ViewBlock],
    damping: float,
    target: CalibrationTarget,
) -> tuple[Array, list[Array]]:
    """Return the step of the shared unknowns and that of each view."""
    normal, right = _reduce(shared, blocks, damping)
    free = free_parameters(target)
    step = np.zeros(len(right))
    step[free] = np.linalg.solve(normal[np.ix_(free, free)], right[free])
    return step, [block.solve(block.right - block.cross @ step, damping) for block in blocks]


def _result(
    views: Sequence[View],
    model: CalibrationModel,
    target: CalibrationTarget,
    sigma: float,
    cost: float,
) -> AdjustmentResult:
    residual = _all_residuals(views, model, target)
    inflation = _correlation_inflation(views, residual, sigma)
    shared, blocks = _normal_equations(views, model, target, sigma * np.sqrt(inflation))
    normal, _ = _reduce(shared, blocks, 0.0)
    free = free_parameters(target)
    covariance = np.zeros_like(normal)
    covariance[np.ix_(free, free)] = np.linalg.inv(normal[np.ix_(free, free)])
    clipped = [np.minimum(np.abs(part), 3.0) for part in residual]
    view_residuals = np.array([np.sqrt((part**2).mean()) for part in clipped])
    return AdjustmentResult(model, covariance, sigma, view_residuals, cost)


def _correlation_inflation(views: Sequence[View], residual: Sequence[Array], sigma: float) -> float:
    """Return by how much the variance of an edge's mean exceeds that of independent rows, ≥ 1.

    The rows of one edge share pixels, light and errors of the model. Treating them as independent
    would understate the uncertainty.
    """
    correlated = independent = 0.0
    for view, part in zip(views, residual, strict=True):
        clipped = np.clip(part, -3 * sigma, 3 * sigma)
        sums = np.bincount(view.lines, weights=clipped)
        correlated += float((sums**2).sum())
        independent += float((clipped**2).sum())
    return max(1.0, correlated / max(independent, 1e-12))
