"""From views to a camera: the stages of a calibration, and what came out of it."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from tracking.calibration import adjustment, lens, start
from tracking.calibration.unknowns import Adjusted, Model, Setting, subset
from tracking.calibration.view import View
from tracking.cube.model import CubeModel
from tracking.errors import TrackingError
from tracking.geometry.intrinsics import Intrinsics

Array = NDArray[np.float64]

FEWEST = 8
"""Fewer views than this make no calibration."""

GOOD, USABLE = 0.005, 0.01
"""How well the focal length should be known, and must be, two standard deviations [share]."""

ODD = 3.0
"""A view with more than this times the usual residual is no view of this target."""

THIRD_PAYS = 25.0
"""k3 is kept where it lowers the cost by more than this: five standard deviations."""

COUNTS = {"pinhole": (0, 1), "lens": (0, 1, 4), "all but k3": range(8), "all": range(9)}
"""Which of the camera's numbers are free in each stage."""


@dataclass(frozen=True)
class Calibration:
    """A camera, and the target it was found with, as they really are."""

    intrinsics: Intrinsics
    """The camera."""

    spread: Array
    """Standard deviations of fx fy cx cy k1 k2 p1 p2 k3, (9,) [px] and 1; 0 for what was held."""

    plates: Array
    """Where each plate really is: `target_from_plate`, (P, 4, 4)."""

    residual: float
    """Robust standard deviation of how far an edge or corner is off [px]."""

    views: int
    """How many views agree with it."""

    @property
    def focal_spread(self) -> float:
        """Standard deviation of the focal length, as a share of it."""
        return float(self.spread[0] / self.intrinsics.matrix[0, 0])

    @property
    def good(self) -> bool:
        """Whether the focal length is known to half a percent (95 %)."""
        return 2 * self.focal_spread <= GOOD

    def check(self) -> None:
        """Refuse a camera that the views do not determine.

        Raises
        ------
        TrackingError
            The focal length is known to less than a percent: the line says what is missing.
        """
        if 2 * self.focal_spread > USABLE:
            raise TrackingError(
                f"the focal length is known to ±{200 * self.focal_spread:.1f} % only, "
                f"±{100 * USABLE:.0f} % is needed: "
                "show the cube or board tilted more, in every direction, and nearer"
            )


def target_of(cube: CubeModel, size: tuple[int, int]) -> Setting:
    """Describe a cube as a target of six plates that may be off their places."""
    centres = np.stack([face.corners.mean(axis=0) for face in cube.faces])
    return Setting(size, np.ones(9, np.bool_), centres, crooked=len(cube.faces) > 1)


def calibrate(views: Sequence[View], target: Setting) -> Calibration:
    """Find the camera that saw these views, and how the target really is.

    Raises
    ------
    TrackingError
        There are too few views, or they do not agree with one another.
    """
    found, agreeing = solve(views, target)
    intrinsics = lens.camera(found.model.camera, target.size)
    spread = np.sqrt(np.diag(found.covariance))[:9]
    return Calibration(intrinsics, spread, found.model.plates, found.residual, len(agreeing))


def solve(views: Sequence[View], target: Setting) -> tuple[Adjusted, list[View]]:
    """Run the stages from a perfect camera to the whole model; see `calibrate`.

    Returns
    -------
    The adjusted model, and the views that agree with it, in the model's order.
    """
    _check_count(len(views))
    camera = start.first_camera(views, target.size)
    model, kept = started(views, camera, target)
    held = replace(target, crooked=False)
    model = adjustment.adjust(kept, model, _freed(held, "pinhole")).model
    model, kept = started(kept, model.camera, target)
    found = adjustment.adjust(kept, model, _freed(target, "lens"))
    found, kept = agreeing(found, kept)
    found = adjustment.adjust(kept, found.model, _freed(target, "all but k3"))
    found, kept = agreeing(found, kept)
    plain = adjustment.adjust(kept, found.model, _freed(target, "all but k3"))
    third = adjustment.adjust(kept, plain.model, _freed(target, "all"))
    pays = plain.cost * (plain.residual / third.residual) ** 2 - third.cost > THIRD_PAYS
    return (third if pays else plain), kept


def started(
    views: Sequence[View], camera: Array, target: Setting, plates: Array | None = None
) -> tuple[Model, list[View]]:
    """Give each view the pose that explains it best under a camera; drop views that have none."""
    pairs = [(view, start.best_pose(view, camera)) for view in views]
    kept = [view for view, pose in pairs if pose is not None]
    _check_count(len(kept))
    poses = np.array([pose for _, pose in pairs if pose is not None])
    if plates is None:
        plates = np.tile(np.eye(4), (len(target.centres), 1, 1))
    return Model(camera, plates, poses, np.zeros(len(kept))), kept


def agreeing(found: Adjusted, views: Sequence[View]) -> tuple[Adjusted, list[View]]:
    """Drop the views whose residuals are odd: a misread marker, a smear, a second cube."""
    usual = max(float(np.median(found.view_residuals)), 0.1)
    chosen = np.flatnonzero(found.view_residuals < ODD * usual).tolist()
    _check_count(len(chosen))
    model = subset(found.model, chosen)
    return replace(found, model=model), [views[number] for number in chosen]


def measured_cube(cube: CubeModel, plates: Array) -> CubeModel:
    """Return the cube with its markers where they were found to be.

    Parameters
    ----------
    cube
        The cube as it should be.
    plates
        `Calibration.plates`.
    """
    faces = []
    for face, plate in zip(cube.faces, plates, strict=True):
        centre = face.corners.mean(axis=0)
        corners = (face.corners - centre) @ plate[:3, :3].T + centre + plate[:3, 3]
        faces.append(replace(face, corners=corners))
    return replace(cube, faces=tuple(faces))


def _freed(target: Setting, stage: str) -> Setting:
    free = np.zeros(9, np.bool_)
    free[list(COUNTS[stage])] = True
    return replace(target, free=free)


def _check_count(count: int) -> None:
    if count < FEWEST:
        raise TrackingError(
            f"only {count} still pictures show the target well, {FEWEST} are needed: "
            "hold it still for a moment in more places, each time tilted another way"
        )
