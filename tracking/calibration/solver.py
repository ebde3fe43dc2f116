"""The stages of a calibration, from views to a camera."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from cubeling.tracking.calibration import camera_vector
from cubeling.tracking.calibration.bundle_adjustment import AdjustmentResult, adjust
from cubeling.tracking.calibration.initialization import best_pose, initial_camera
from cubeling.tracking.calibration.model import CalibrationModel, CalibrationTarget
from cubeling.tracking.calibration.view import View
from cubeling.tracking.cube.model import CubeModel
from cubeling.tracking.errors import TrackingError
from cubeling.tracking.geometry.arrays import Array
from cubeling.tracking.geometry.intrinsics import Intrinsics

MIN_VIEWS = 8
"""Minimum number of views of a calibration."""

GOOD_FOCAL_ERROR, MAX_FOCAL_ERROR = 0.005, 0.01
"""Relative uncertainty of the focal length (two standard deviations) to aim at, and to accept."""

LEAST_FOCAL_DEVIATION = 0.002
"""Standard deviation that is stated of a focal length at least, as a share of it: paper bends."""

MAX_RESIDUAL_RATIO = 3.0
"""A view with more than this times the median residual does not show this target."""

MIN_K3_GAIN = 25.0
"""k3 is kept if it reduces the cost by more than this: five standard deviations."""

FREE_PARAMETERS = {
    "focal length": (0, 1),
    "radial": (0, 1, 4),
    "all but k3": range(8),
    "all": range(9),
}
"""Indices of the camera's free parameters in each stage."""


@dataclass(frozen=True)
class Calibration:
    """A camera, and the actual shape of the target that it was calibrated with."""

    intrinsics: Intrinsics

    spread: Array
    """Standard deviations of fx fy cx cy [px] k1 k2 p1 p2 k3, (9,); 0 for fixed parameters."""

    plates: Array
    """Actual pose of each plate: `target_from_plate`, (P, 4, 4)."""

    residual: float
    """Robust standard deviation of the edges' or corners' residuals [px]."""

    views: int
    """Number of views that agree with it."""

    @property
    def focal_spread(self) -> float:
        """Standard deviation of the focal length, relative to it."""
        return float(self.spread[0] / self.intrinsics.matrix[0, 0])

    @property
    def good(self) -> bool:
        """Whether the focal length is known to half a percent (95 %)."""
        return 2 * self.focal_spread <= GOOD_FOCAL_ERROR

    def check(self) -> None:
        """Refuse a camera that the views do not determine.

        Raises
        ------
        TrackingError
            The focal length is uncertain by more than a percent.
        """
        if 2 * self.focal_spread > MAX_FOCAL_ERROR:
            raise TrackingError(
                f"the focal length is known to ±{200 * self.focal_spread:.1f} % only, "
                f"±{100 * MAX_FOCAL_ERROR:.0f} % is needed: "
                "show the cube or board tilted more, in every direction, and nearer"
            )


def calibrate(views: Sequence[View], target: CalibrationTarget) -> Calibration:
    """Find the camera that took these views, and the actual shape of the target.

    The stages go from a camera without distortion to the full model.

    Raises
    ------
    TrackingError
        There are too few views, or they contradict each other.
    """
    return solve(views, target)[0]


def solve(views: Sequence[View], target: CalibrationTarget) -> tuple[Calibration, list[View]]:
    """Do the same as `calibrate`; return also the views that agree with the calibration."""
    _check_count(len(views))
    rigid = replace(target, adjust_plates=False)
    model, kept = fit_poses(views, initial_camera(views, target.size), rigid)
    model = _adjust(kept, model, "focal length").model
    model, kept = fit_poses(kept, model.camera, target)
    model, kept = _without_outliers(kept, _adjust(kept, model, "radial"))
    model, kept = _without_outliers(kept, _adjust(kept, model, "all but k3"))
    best = _adjust(kept, model, "all but k3")
    with_k3 = _adjust(kept, best.model, "all")
    if best.cost * (best.residual / with_k3.residual) ** 2 - with_k3.cost > MIN_K3_GAIN:
        best = with_k3
    intrinsics = camera_vector.to_intrinsics(best.model.camera, target.size)
    spread = np.sqrt(np.diag(best.covariance))[:9]
    deviation = max(float(spread[0] / intrinsics.matrix[0, 0]), LEAST_FOCAL_DEVIATION)
    intrinsics = replace(intrinsics, focal_deviation=deviation)
    calibration = Calibration(intrinsics, spread, best.model.plates, best.residual, len(kept))
    return calibration, kept


def fit_poses(
    views: Sequence[View], camera: Array, target: CalibrationTarget, plates: Array | None = None
) -> tuple[CalibrationModel, list[View]]:
    """Find the best pose of each view for a camera; drop views that have none."""
    pairs = [(view, best_pose(view, camera)) for view in views]
    kept = [view for view, pose in pairs if pose is not None]
    _check_count(len(kept))
    poses = np.array([pose for _, pose in pairs if pose is not None])
    if plates is None:
        plates = np.tile(np.eye(4), (len(target.centres), 1, 1))
    return CalibrationModel(target, camera, plates, poses, np.zeros(len(kept))), kept


def _adjust(views: Sequence[View], model: CalibrationModel, stage: str) -> AdjustmentResult:
    free = np.zeros(9, np.bool_)
    free[list(FREE_PARAMETERS[stage])] = True
    return adjust(views, replace(model, target=replace(model.target, free=free)))


def _without_outliers(
    views: Sequence[View], result: AdjustmentResult
) -> tuple[CalibrationModel, list[View]]:
    """Drop views with large residuals: a misread marker, motion blur, a second cube."""
    usual = max(float(np.median(result.view_residuals)), 0.1)
    chosen = np.flatnonzero(result.view_residuals < MAX_RESIDUAL_RATIO * usual).tolist()
    _check_count(len(chosen))
    poses, blooms = result.model.poses[chosen], result.model.blooms[chosen]
    return replace(result.model, poses=poses, blooms=blooms), [views[number] for number in chosen]


def measured_cube(cube: CubeModel, plates: Array) -> CubeModel:
    """Return the cube with its markers where the calibration found them.

    Parameters
    ----------
    cube
        The nominal cube.
    plates
        `Calibration.plates`, (P, 4, 4): one for each face, in the order of `cube.faces`.
    """
    faces = []
    for face, plate in zip(cube.faces, plates, strict=True):
        centre = face.corners.mean(axis=0)
        corners = (face.corners - centre) @ plate[:3, :3].T + centre + plate[:3, 3]
        faces.append(replace(face, corners=corners))
    return replace(cube, faces=tuple(faces))


def _check_count(count: int) -> None:
    if count < MIN_VIEWS:
        raise TrackingError(
            f"too few still images show the target well, {count} of {MIN_VIEWS}: "
            "hold it still for a moment in more places, each time tilted in another direction"
        )
