"""Bundle adjustment: camera, plates and views together, so that every edge lies in its place.

Levenberg-Marquardt on the normal equations. A view touches only its own seven unknowns (pose and
bloom) and those that all share (nine of the camera, six for each plate), so the views are
eliminated one by one (Schur complement; Triggs et al., 2000, section 6), and what is solved has 15
to 45 unknowns however many views there are.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from tracking import se3
from tracking.calibration import lens
from tracking.calibration.view import View

Array = NDArray[np.float64]

PRIOR_PLATE = (0.0012, np.deg2rad(1.2))
"""How far a face of a hand-made cube is off, one standard deviation [m], [rad]."""

PRIOR_BLOOM = 0.3
"""How far white may grow over black [px], one standard deviation."""

QUIETEST = 0.02
"""The error of a row is never taken to be smaller than this [px]."""

NEAREST = 0.02
"""No point of the target is nearer to the camera than this [m]."""

ROUNDS = 40
"""Steps of Levenberg-Marquardt at most."""

DONE = 1e-4
"""A step that lowers the cost by less than this is the last one."""


@dataclass(frozen=True)
class Model:
    """All unknowns of a calibration."""

    camera: Array
    """The camera's numbers, (9,); see `lens.PARAMETERS`."""

    plates: Array
    """`target_from_plate` for each plate, (P, 4, 4): where a point that should be at x really is.
    Identity for a perfect target."""

    poses: Array
    """`camera_from_target` of each view, (V, 4, 4)."""

    blooms: Array
    """How far white has grown in each view [px], (V,)."""


@dataclass(frozen=True)
class Adjusted:
    """The best model, and how sure it is."""

    model: Model
    """The unknowns."""

    covariance: Array
    """Of the camera's nine numbers, then of the plates' shift-turns, (9 + 6 P,) squared; zero for
    what was held."""

    residual: float
    """Robust standard deviation of a row [px]."""

    view_residuals: Array
    """Root mean square of each view's rows [px], outliers left in but cut at 3 px, (V,)."""

    cost: float
    """What was minimised: squared errors in units of their standard deviations, priors included."""


@dataclass(frozen=True)
class Setting:
    """What is free and what is known beforehand."""

    size: tuple[int, int]
    """Of the pictures [px]."""

    free: NDArray[np.bool_]
    """Which of the camera's numbers may move, (9,)."""

    centres: Array
    """Where the centres of the plates should be, (P, 3) [m]; they turn about these."""

    crooked: bool
    """Whether the plates may be off their places; a board's one plate is the target itself."""


def adjust(views: Sequence[View], start: Model, setting: Setting) -> Adjusted:
    """Move all unknowns to where the measurements put them."""
    model, damping = start, 1e-3
    sigma = _spread(views, model, setting)
    shared, steps = _normal_equations(views, model, setting, sigma)
    cost = _cost(views, model, setting, sigma)
    for _ in range(ROUNDS):
        moved = _stepped(model, setting, *_solved(shared, steps, damping, setting))
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


def errors(view: View, model: Model, number: int, setting: Setting) -> Array:
    """How far each row of a view is off [px], (N,)."""
    return _rows(view, model, number, setting)[0]


def _rows(
    view: View, model: Model, number: int, setting: Setting
) -> tuple[Array, Array, Array, Array]:
    """Return errors (N,) and their slopes by camera (N, 9), own plate (N, 6) and view (N, 7)."""
    offsets = view.points - setting.centres[view.plates]
    plates = model.plates[view.plates]
    turned = np.einsum("nij,nj->ni", plates[:, :3, :3], offsets)
    places = turned + setting.centres[view.plates] + plates[:, :3, 3]
    turn, origin = model.poses[number, :3, :3], model.poses[number, :3, 3]
    swung = places @ turn.T
    seen = swung + origin
    seen = np.where(seen[:, 2:] < NEAREST, seen * (1, 1, 0) + (0, 0, NEAREST), seen)
    pixels, by_point, by_camera = lens.projected(model.camera, seen)
    away = np.einsum("ni,ni->n", view.normals, view.pixels - pixels)
    away -= view.bloom * model.blooms[number]
    across = np.einsum("ni,nij->nj", view.normals, by_point)
    on_plate = across @ turn
    camera = np.einsum("ni,nij->nj", view.normals, by_camera)
    plate = np.concatenate([on_plate, np.cross(turned, on_plate)], axis=1)
    own = np.concatenate([across, np.cross(swung, across), view.bloom[:, None]], axis=1)
    return away, camera, plate, own


def _huber(away: Array, sigma: float) -> Array:
    """Weights that let no row pull harder than one that is two standard deviations off."""
    return np.asarray(1 / np.maximum(1.0, np.abs(away) / (2 * sigma)), np.float64)


def _spread(views: Sequence[View], model: Model, setting: Setting) -> float:
    """Return the robust standard deviation of a row [px], what the unknowns took up given back."""
    away = np.concatenate([errors(view, model, n, setting) for n, view in enumerate(views)])
    unknowns = 7 * len(views) + len(_movable(setting, 9 + 6 * len(model.plates)))
    taken = len(away) / max(len(away) - unknowns, 0.25 * len(away))
    return max(QUIETEST, 1.4826 * float(np.median(np.abs(away))) * float(np.sqrt(taken)))


def _cost(views: Sequence[View], model: Model, setting: Setting, sigma: float) -> float:
    total = 0.0
    for number, view in enumerate(views):
        away = np.abs(errors(view, model, number, setting)) / sigma
        total += float(np.where(away < 2, away**2, 4 * away - 4).sum())
    return total + float((model.blooms**2).sum()) / PRIOR_BLOOM**2 + _prior_cost(model, setting)


def _prior_cost(model: Model, setting: Setting) -> float:
    rows, values = lens.prior(setting.size, model.camera[0], setting.free)
    cost = float(((rows @ model.camera - values) ** 2).sum())
    for plate in model.plates if setting.crooked else ():
        step = se3.motion(np.eye(4), plate)
        cost += float((step[:3] ** 2).sum()) / PRIOR_PLATE[0] ** 2
        cost += float((step[3:] ** 2).sum()) / PRIOR_PLATE[1] ** 2
    return cost


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
        away, camera, plate, own = _rows(view, model, number, setting)
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
    _add_priors(normal, right, model, setting)
    return (normal, right), steps


def _add_priors(normal: Array, right: Array, model: Model, setting: Setting) -> None:
    rows, values = lens.prior(setting.size, model.camera[0], setting.free)
    normal[:9, :9] += rows.T @ rows
    right[:9] -= rows.T @ (rows @ model.camera - values)
    for number, plate in enumerate(model.plates):
        at = slice(9 + 6 * number, 15 + 6 * number)
        strength = np.repeat(1 / np.square(PRIOR_PLATE), 3)
        normal[at, at] += np.diag(strength)
        right[at] -= strength * se3.motion(np.eye(4), plate)


def _movable(setting: Setting, count: int) -> NDArray[np.intp]:
    free = np.full(count, setting.crooked)
    free[:9] = setting.free
    return np.flatnonzero(free)


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
    movable = _movable(setting, len(right))
    solution = np.zeros(len(right))
    solution[movable] = np.linalg.solve(normal[np.ix_(movable, movable)], right[movable])
    own: list[Array] = []
    for step in steps:
        block = step.own + damping * np.diag(np.diag(step.own))
        own.append(np.asarray(np.linalg.solve(block, step.right - step.cross @ solution)))
    return solution, own


def _stepped(model: Model, setting: Setting, shared: Array, own: Sequence[Array]) -> Model:
    camera = model.camera + shared[:9]
    # A focal length cannot leave the range of cameras, whatever one bad step says.
    camera[:2] = np.clip(camera[:2], 0.2 * setting.size[0], 8 * setting.size[0])
    plates = [
        se3.moved(plate, step)
        for plate, step in zip(model.plates, shared[9:].reshape(-1, 6), strict=True)
    ]
    poses = [se3.moved(pose, step[:6]) for pose, step in zip(model.poses, own, strict=True)]
    blooms = model.blooms + np.array([step[6] for step in own])
    return Model(camera, np.array(plates), np.array(poses), blooms)


def _finished(
    views: Sequence[View], model: Model, setting: Setting, sigma: float, cost: float
) -> Adjusted:
    away = [errors(view, model, number, setting) for number, view in enumerate(views)]
    alike = _alike(views, away, sigma)
    shared, steps = _normal_equations(views, model, setting, sigma * np.sqrt(alike))
    normal, _ = _reduced(shared, steps, 0.0)
    movable = _movable(setting, len(normal))
    covariance = np.zeros_like(normal)
    covariance[np.ix_(movable, movable)] = np.linalg.inv(normal[np.ix_(movable, movable)])
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


def subset(model: Model, chosen: Sequence[int]) -> Model:
    """Return the model of some of the views."""
    return replace(model, poses=model.poses[list(chosen)], blooms=model.blooms[list(chosen)])
