"""Checking whether a saved camera file still fits the camera."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from cubeling.tracking.calibration import camera_vector
from cubeling.tracking.calibration.bundle_adjustment import adjust
from cubeling.tracking.calibration.model import CalibrationTarget
from cubeling.tracking.calibration.solver import fit_poses, solve
from cubeling.tracking.calibration.view import View
from cubeling.tracking.geometry.intrinsics import Intrinsics

MAX_FOCAL_CHANGE = 0.01
"""Relative change of the focal length that is tolerated, ..."""

MAX_FOCAL_CHANGE_SIGMAS = 3.0
"""... or this many standard deviations, if that is more."""

MAX_RESIDUAL_RATIO, MAX_RESIDUAL_EXCESS_PX = 1.5, 0.05
"""The residual may exceed that of the best camera by this factor plus this amount."""


@dataclass(frozen=True)
class CameraCheck:
    """A saved camera compared with the one that fits best now."""

    residual: float
    """Robust standard deviation of the edges' residuals with the saved camera [px]."""

    best_residual: float
    """The same with the camera that fits best [px]."""

    focal_change: float
    """Relative change of the focal length since the camera was saved."""

    focal_spread: float
    """Standard deviation of that change."""

    centre_change: tuple[float, float]
    """Shift of the principal point [px]."""

    views: int
    """Number of views used."""

    @property
    def degraded(self) -> bool:
        """Whether the saved camera should not be used any more."""
        tolerance = max(MAX_FOCAL_CHANGE, MAX_FOCAL_CHANGE_SIGMAS * self.focal_spread)
        max_residual = MAX_RESIDUAL_RATIO * self.best_residual + MAX_RESIDUAL_EXCESS_PX
        return abs(self.focal_change) > tolerance or self.residual > max_residual


def check_camera(
    views: Sequence[View], saved: Intrinsics, target: CalibrationTarget
) -> CameraCheck:
    """Compare a saved camera with views taken now.

    The saved distortion is removed from the views first, so that any distortion model can be
    checked; distortion that remains is a change.

    Raises
    ------
    TrackingError
        The views do not determine the camera: too few, contradictory, or not tilted.
    """
    now, kept = solve([_undistort(saved, view) for view in views], target)
    now.check()
    pinhole = camera_vector.from_intrinsics(replace(saved, distortion=np.zeros(5)))
    fixed = replace(target, free=np.zeros(9, np.bool_))
    model, kept = fit_poses(kept, pinhole, fixed, now.plates)
    with_saved = adjust(kept, model)
    change = now.intrinsics.matrix - saved.matrix
    return CameraCheck(
        with_saved.residual,
        now.residual,
        float(now.intrinsics.matrix[0, 0] / saved.matrix[0, 0] - 1),
        now.focal_spread,
        (float(change[0, 2]), float(change[1, 2])),
        len(kept),
    )


def _undistort(camera: Intrinsics, view: View) -> View:
    """Return a view as the same camera without distortion would see it."""
    along = np.stack([-view.normals[:, 1], view.normals[:, 0]], axis=1)
    # Only the edge's direction is known exactly, so the new normal is perpendicular to its image.
    across, tangents = (
        camera.undistort(view.pixels + way / 2) - camera.undistort(view.pixels - way / 2)
        for way in (view.normals, along)
    )
    normals = np.stack([tangents[:, 1], -tangents[:, 0]], axis=1)
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    normals *= np.sign(np.einsum("ni,ni->n", normals, across))[:, None]
    return replace(view, pixels=camera.undistort(view.pixels), normals=normals)
