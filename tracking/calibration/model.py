"""The unknowns of a calibration: their residuals, derivatives and priors."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from tracking.calibration import camera_vector
from tracking.calibration.view import View
from tracking.geometry import se3

Array = NDArray[np.float64]

PLATE_SHIFT_SIGMA_M, PLATE_ROTATION_SIGMA_RAD = 0.0012, np.deg2rad(1.2)
"""Prior standard deviations of a face of a hand-made cube about its nominal pose."""

BLOOM_SIGMA_PX = 0.3
"""Prior standard deviation of the bloom of white over black."""

MIN_DEPTH_M = 0.02
"""Points nearer to the camera are moved to this depth, so that the projection stays finite."""


@dataclass(frozen=True)
class CalibrationModel:
    """Values of all unknowns of a calibration."""

    camera: Array
    """Parameters of the camera, (9,); see `camera_vector.PARAMETERS`."""

    plates: Array
    """`target_from_plate` of each plate, (P, 4, 4): the actual pose of a plate relative to its
    nominal pose. Identity for a perfect target."""

    poses: Array
    """`camera_from_target` of each view, (V, 4, 4)."""

    blooms: Array
    """How far white grows over black in each view [px], (V,)."""

    def of_views(self, chosen: Sequence[int]) -> "CalibrationModel":
        """Return the model of some of the views."""
        return replace(self, poses=self.poses[list(chosen)], blooms=self.blooms[list(chosen)])


@dataclass(frozen=True)
class CalibrationTarget:
    """What is known about the target and the images, and which unknowns are free."""

    size: tuple[int, int]
    """Size of the images [px]."""

    free: NDArray[np.bool_]
    """Which of the camera's parameters are free, (9,)."""

    centres: Array
    """Nominal centre of each plate, about which it rotates, (P, 3) [m]."""

    adjust_plates: bool
    """Whether the poses of the plates are free. False for a board: its one plate is the target."""


def residuals(view: View, model: CalibrationModel, number: int, target: CalibrationTarget) -> Array:
    """Return measured minus predicted position of each row of view `number` [px], (N,)."""
    return linearise(view, model, number, target)[0]


def linearise(
    view: View, model: CalibrationModel, number: int, target: CalibrationTarget
) -> tuple[Array, Array, Array, Array]:
    """Return the residuals of view `number` and the derivatives of the prediction.

    Returns
    -------
    Residuals (N,) [px]; derivatives by the camera (N, 9), by the plate's pose (N, 6), and by the
    view's pose and bloom (N, 7). Steps of poses are as in `se3.moved`.
    """
    offsets = view.points - target.centres[view.plates]
    plates = model.plates[view.plates]
    rotated = np.einsum("nij,nj->ni", plates[:, :3, :3], offsets)
    in_target = rotated + target.centres[view.plates] + plates[:, :3, 3]
    rotation, origin = model.poses[number, :3, :3], model.poses[number, :3, 3]
    turned = in_target @ rotation.T
    points = turned + origin
    near = points[:, 2:] < MIN_DEPTH_M
    points = np.where(near, points * (1, 1, 0) + (0, 0, MIN_DEPTH_M), points)
    pixels, by_point, by_camera = camera_vector.project(model.camera, points)
    residual = np.einsum("ni,ni->n", view.normals, view.pixels - pixels)
    residual -= view.bloom * model.blooms[number]
    by_point = np.einsum("ni,nij->nj", view.normals, by_point)
    by_camera = np.einsum("ni,nij->nj", view.normals, by_camera)
    in_plate = by_point @ rotation
    by_plate = np.concatenate([in_plate, np.cross(rotated, in_plate)], axis=1)
    by_view = np.concatenate([by_point, np.cross(turned, by_point), view.bloom[:, None]], axis=1)
    return residual, by_camera, by_plate, by_view


def prior_cost(model: CalibrationModel, target: CalibrationTarget) -> float:
    """Return the cost of camera and plates by their priors alone."""
    rows, values = camera_vector.prior(target.size, model.camera[0], target.free)
    cost = float(((rows @ model.camera - values) ** 2).sum())
    for plate in model.plates if target.adjust_plates else ():
        step = se3.delta(np.eye(4), plate)
        cost += float((step[:3] ** 2).sum()) / PLATE_SHIFT_SIGMA_M**2
        cost += float((step[3:] ** 2).sum()) / PLATE_ROTATION_SIGMA_RAD**2
    return cost


def add_priors(
    normal: Array, right: Array, model: CalibrationModel, target: CalibrationTarget
) -> None:
    """Add the priors of camera and plates to the shared normal equations, in place."""
    rows, values = camera_vector.prior(target.size, model.camera[0], target.free)
    normal[:9, :9] += rows.T @ rows
    right[:9] -= rows.T @ (rows @ model.camera - values)
    weights = np.repeat(1 / np.square((PLATE_SHIFT_SIGMA_M, PLATE_ROTATION_SIGMA_RAD)), 3)
    for number, plate in enumerate(model.plates):
        at = slice(9 + 6 * number, 15 + 6 * number)
        normal[at, at] += np.diag(weights)
        right[at] -= weights * se3.delta(np.eye(4), plate)


def free_parameters(target: CalibrationTarget) -> NDArray[np.intp]:
    """Return the indices of the free ones among the 9 + 6 P parameters of camera and plates."""
    free = np.full(9 + 6 * len(target.centres), target.adjust_plates)
    free[:9] = target.free
    return np.flatnonzero(free)


def apply_step(
    model: CalibrationModel, target: CalibrationTarget, shared: Array, by_view: Sequence[Array]
) -> CalibrationModel:
    """Apply a step of camera and plates (9 + 6 P,) and one of each view (7,)."""
    camera = model.camera + shared[:9]
    # A single bad step must not take the focal length out of the range of real cameras.
    camera[:2] = np.clip(camera[:2], 0.2 * target.size[0], 8 * target.size[0])
    plates = [
        se3.moved(plate, step)
        for plate, step in zip(model.plates, shared[9:].reshape(-1, 6), strict=True)
    ]
    poses = [se3.moved(pose, step[:6]) for pose, step in zip(model.poses, by_view, strict=True)]
    blooms = model.blooms + np.array([step[6] for step in by_view])
    return CalibrationModel(camera, np.array(plates), np.array(poses), blooms)
