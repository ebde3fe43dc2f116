"""Whether a saved camera still is the camera."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from tracking.calibration import adjustment, lens
from tracking.calibration.solving import Calibration, solve, started
from tracking.calibration.unknowns import Setting
from tracking.calibration.view import View
from tracking.geometry.intrinsics import Intrinsics

Array = NDArray[np.float64]

FOCAL_DRIFT = 0.01
"""A focal length that is off by more than this share is no longer the camera's."""

SURE = 3.0
"""… if that is more than this many standard deviations."""

WORSE = (1.5, 0.05)
"""Edges may lie off by this factor more than with the best camera, and by this more [px]."""


@dataclass(frozen=True)
class Check:
    """How a saved camera compares with the one that fits best now."""

    residual: float
    """Robust standard deviation of how far edges lie off under the saved camera [px]."""

    best_residual: float
    """The same under the camera that fits best [px]."""

    focal_change: float
    """How much longer the focal length is now, as a share."""

    focal_spread: float
    """Standard deviation of that."""

    centre_change: tuple[float, float]
    """How far the principal point has moved [px]."""

    views: int
    """How many views it was judged by."""

    @property
    def degraded(self) -> bool:
        """Whether the saved camera should not be used any more."""
        drifted = abs(self.focal_change) > max(FOCAL_DRIFT, SURE * self.focal_spread)
        return drifted or self.residual > WORSE[0] * self.best_residual + WORSE[1]

    @property
    def verdict(self) -> str:
        """The word for it: OK or DEGRADED."""
        return "DEGRADED" if self.degraded else "OK"


def check(views: Sequence[View], saved: Intrinsics, target: Setting) -> Check:
    """Hold a saved camera against views.

    The views are first seen through the saved lens, so that any lens model can be checked; what
    is left of a lens then is what has changed.

    Raises
    ------
    TrackingError
        The views do not tell: too few, not alike, or not tilted.
    """
    straight = [through(saved, view) for view in views]
    found, kept = solve(straight, target)
    now = Calibration(
        lens.camera(found.model.camera, target.size),
        np.sqrt(np.diag(found.covariance))[:9],
        found.model.plates,
        found.residual,
        len(kept),
    )
    now.check()
    pinhole = np.array([*lens.vector(replace(saved, distortion=np.zeros(5)))[:4], *np.zeros(5)])
    held = replace(target, free=np.zeros(9, np.bool_))
    model, kept = started(kept, pinhole, target, found.model.plates)
    under = adjustment.adjust(kept, model, held)
    return Check(
        under.residual,
        found.residual,
        float(now.intrinsics.matrix[0, 0] / saved.matrix[0, 0] - 1),
        now.focal_spread,
        (
            float(now.intrinsics.matrix[0, 2] - saved.matrix[0, 2]),
            float(now.intrinsics.matrix[1, 2] - saved.matrix[1, 2]),
        ),
        len(kept),
    )


def through(camera: Intrinsics, view: View) -> View:
    """Return a view as the same camera with a perfect lens would see it."""
    pixels = camera.undistorted(view.pixels)
    beside = camera.undistorted(view.pixels + view.normals / 2) - camera.undistorted(
        view.pixels - view.normals / 2
    )
    # Along an edge nothing was measured, so the edge's own direction says where its normal is.
    along = np.stack([-view.normals[:, 1], view.normals[:, 0]], axis=1)
    run = camera.undistorted(view.pixels + along / 2) - camera.undistorted(view.pixels - along / 2)
    normals = np.stack([run[:, 1], -run[:, 0]], axis=1)
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    normals *= np.sign(np.einsum("ni,ni->n", normals, beside))[:, None]
    return replace(view, pixels=pixels, normals=normals)
