"""Bundle adjustment: camera, plates and views together, so that every edge lies in its place.

Levenberg-Marquardt on the normal equations. A view touches only its own seven unknowns (pose and
bloom) and those that all share (nine of the camera, six for each plate), so the views are
eliminated one by one (Schur complement; Triggs et al., 2000, section 6), and what is solved has 15
to 45 unknowns however many views there are.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tracking.calibration.unknowns import (
    PRIOR_BLOOM,
    Adjusted,
    Model,
    Setting,
    add_priors,
    errors,
    linearised,
    movable,
    prior_cost,
    stepped,
)
from tracking.calibration.view import View

Array = NDArray[np.float64]

QUIETEST = 0.02
"""The error of a row is never taken to be smaller than this [px]."""

ROUNDS = 40
"""Steps of Levenberg-Marquardt at most."""

DONE = 1e-4
"""A step that lowers the cost by less than this is the last one."""


def adjust(views: Sequence[View], start: Model, setting: Setting) -> Adjusted:
    """Move all unknowns to where the measurements put them."""
    model, damping = start, 1e-3
    sigma = _spread(views, model, setting)
    shared, steps = _normal_equations(views, model, setting, sigma)
    cost = _cost(views, model, setting, sigma)
    for _ in range(ROUNDS):
        moved = stepped(model, setting, *_solved(shared, steps, damping, setting))
        after = _cost(views, moved, setting, sigma)
        if after > cost:
            damping *= 8
            if damping > 1e6:
                break
            continue
        gained = cost - after
        model, damping = moved, max(1e-9, damping / 5)
        sigma = _spread(views, model, setting)
        shared, steps = _normal_equations(views, model, setting, sigma)
        cost = _cost(views, model, setting, sigma)
        if gained < DONE * max(1.0, cost) * 0.01:
            break
    return _finished(views, model, setting, sigma, cost)


def _huber(away: Array, sigma: float) -> Array:
    """Weights that let no row pull harder than one that is two standard deviations off."""
    return np.asarray(1 / np.maximum(1.0, np.abs(away) / (2 * sigma)), np.float64)


def _spread(views: Sequence[View], model: Model, setting: Setting) -> float:
    """Return the robust standard deviation of a row [px], what the unknowns took up given back."""
    away = np.concatenate([errors(view, model, n, setting) for n, view in enumerate(views)])
    unknowns = 7 * len(views) + len(movable(setting, 9 + 6 * len(model.plates)))
    taken = len(away) / max(len(away) - unknowns, 0.25 * len(away))
    return max(QUIETEST, 1.4826 * float(np.median(np.abs(away))) * float(np.sqrt(taken)))


def _cost(views: Sequence[View], model: Model, setting: Setting, sigma: float) -> float:
    total = 0.0
    for number, view in enumerate(views):
        away = np.abs(errors(view, model, number, setting)) / sigma
        total += float(np.where(away < 2, away**2, 4 * away - 4).sum())
    return total + float((model.blooms**2).sum()) / PRIOR_BLOOM**2 + prior_cost(model, setting)


Blocks = tuple[Array, Array]
"""Normal matrix and right side."""


@dataclass(frozen=True)
class _Step:
    """What is needed to find a view's own step when the shared one is known."""

    own: Array
    right: Array
    cross: Array


def _normal_equations(
    views: Sequence[View], model: Model, setting: Setting, sigma: float
) -> tuple[Blocks, list[_Step]]:
    count = 9 + 6 * len(model.plates)
    normal, right, steps = np.zeros((count, count)), np.zeros(count), []
    for number, view in enumerate(views):
        away, camera, plate, own = linearised(view, model, number, setting)
        rows = np.zeros((len(away), count))
        rows[:, :9] = camera
        columns = 9 + 6 * view.plates[:, None] + np.arange(6)
        np.put_along_axis(rows, columns, plate, axis=1)
        weights = _huber(away, sigma)[:, None] / sigma**2
        normal += rows.T @ (rows * weights)
        right += (rows * weights).T @ away
        block = own.T @ (own * weights)
        pull = (own * weights).T @ away
        block[6, 6] += 1 / PRIOR_BLOOM**2
        pull[6] -= model.blooms[number] / PRIOR_BLOOM**2
        steps.append(_Step(block, pull, own.T @ (rows * weights)))
    add_priors(normal, right, model, setting)
    return (normal, right), steps


def _reduced(shared: Blocks, steps: Sequence[_Step], damping: float) -> Blocks:
    """Eliminate the views."""
    normal, right = shared[0].copy(), shared[1].copy()
    normal[np.diag_indices(len(normal))] *= 1 + damping
    for step in steps:
        own = step.own + damping * np.diag(np.diag(step.own))
        solved = np.linalg.solve(own, np.column_stack([step.cross, step.right]))
        normal -= step.cross.T @ solved[:, :-1]
        right -= step.cross.T @ solved[:, -1]
    return normal, right


def _solved(
    shared: Blocks, steps: Sequence[_Step], damping: float, setting: Setting
) -> tuple[Array, list[Array]]:
    normal, right = _reduced(shared, steps, damping)
    moving = movable(setting, len(right))
    solution = np.zeros(len(right))
    solution[moving] = np.linalg.solve(normal[np.ix_(moving, moving)], right[moving])
    own: list[Array] = []
    for step in steps:
        block = step.own + damping * np.diag(np.diag(step.own))
        own.append(np.asarray(np.linalg.solve(block, step.right - step.cross @ solution)))
    return solution, own


def _finished(
    views: Sequence[View], model: Model, setting: Setting, sigma: float, cost: float
) -> Adjusted:
    away = [errors(view, model, number, setting) for number, view in enumerate(views)]
    alike = _alike(views, away, sigma)
    shared, steps = _normal_equations(views, model, setting, sigma * np.sqrt(alike))
    normal, _ = _reduced(shared, steps, 0.0)
    moving = movable(setting, len(normal))
    covariance = np.zeros_like(normal)
    covariance[np.ix_(moving, moving)] = np.linalg.inv(normal[np.ix_(moving, moving)])
    cut = [np.minimum(np.abs(part), 3.0) for part in away]
    spreads = np.array([np.sqrt((part**2).mean()) for part in cut])
    return Adjusted(model, covariance, sigma, spreads, cost)


def _alike(views: Sequence[View], away: Sequence[Array], sigma: float) -> float:
    """How much larger the variance of a line's mean is than if its rows erred on their own, ≥ 1.

    The rows of one line share pixels, light and the model's faults. Counting them as independent
    would make the uncertainties too small.
    """
    together = alone = 0.0
    for view, part in zip(views, away, strict=True):
        held = np.clip(part, -3 * sigma, 3 * sigma)
        sums = np.bincount(view.lines, weights=held)
        together += float((sums**2).sum())
        alone += float((held**2).sum())
    return max(1.0, together / max(alone, 1e-12))
