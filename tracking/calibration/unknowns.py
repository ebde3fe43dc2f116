"""The unknowns of a calibration: their rows in the least squares, and what is known beforehand."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from tracking.calibration import lens
from tracking.calibration.view import View
from tracking.geometry import se3

Array = NDArray[np.float64]

PRIOR_PLATE = (0.0012, np.deg2rad(1.2))
"""How far a face of a hand-made cube is off, one standard deviation [m], [rad]."""

PRIOR_BLOOM = 0.3
"""How far white may grow over black [px], one standard deviation."""

NEAREST = 0.02
"""No point of the target is nearer to the camera than this [m]."""


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


def errors(view: View, model: Model, number: int, setting: Setting) -> Array:
    """How far each row of a view is off [px], (N,)."""
    return linearised(view, model, number, setting)[0]


def linearised(
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


def prior_cost(model: Model, setting: Setting) -> float:
    """Return what the model costs before anything is seen."""
    rows, values = lens.prior(setting.size, model.camera[0], setting.free)
    cost = float(((rows @ model.camera - values) ** 2).sum())
    for plate in model.plates if setting.crooked else ():
        step = se3.motion(np.eye(4), plate)
        cost += float((step[:3] ** 2).sum()) / PRIOR_PLATE[0] ** 2
        cost += float((step[3:] ** 2).sum()) / PRIOR_PLATE[1] ** 2
    return cost


def add_priors(normal: Array, right: Array, model: Model, setting: Setting) -> None:
    """Add what is known of camera and plates to the shared normal equations, in place."""
    rows, values = lens.prior(setting.size, model.camera[0], setting.free)
    normal[:9, :9] += rows.T @ rows
    right[:9] -= rows.T @ (rows @ model.camera - values)
    for number, plate in enumerate(model.plates):
        at = slice(9 + 6 * number, 15 + 6 * number)
        strength = np.repeat(1 / np.square(PRIOR_PLATE), 3)
        normal[at, at] += np.diag(strength)
        right[at] -= strength * se3.motion(np.eye(4), plate)


def movable(setting: Setting, count: int) -> NDArray[np.intp]:
    """Return the numbers of the shared unknowns that are free, of `count`."""
    free = np.full(count, setting.crooked)
    free[:9] = setting.free
    return np.flatnonzero(free)


def stepped(model: Model, setting: Setting, shared: Array, own: Sequence[Array]) -> Model:
    """Move the unknowns by a step: camera and plates (9 + 6 P,), and (7,) for each view."""
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


def subset(model: Model, chosen: Sequence[int]) -> Model:
    """Return the model of some of the views."""
    return replace(model, poses=model.poses[list(chosen)], blooms=model.blooms[list(chosen)])
