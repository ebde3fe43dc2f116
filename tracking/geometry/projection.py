"""Points to pixels and back, through the lens."""

import cv2
import numpy as np
from numpy.typing import NDArray

from tracking.geometry.intrinsics import Intrinsics

Array = NDArray[np.float64]


MIN_DEPTH = 0.03
"""A cube closer to the camera than this [m] cannot be seen whole; a pose that says so is wrong."""


class Projection:
    """The pinhole with its lens distortion, for any distortion model that OpenCV knows.

    A pixel's coordinates are those of its centre: the first pixel covers −0.5…0.5.
    """

    def __init__(self, intrinsics: Intrinsics) -> None:
        self.intrinsics = intrinsics
        self.matrix = np.asarray(intrinsics.matrix, np.float64)
        self.distortion = np.asarray(intrinsics.distortion, np.float64).ravel()
        self.size = intrinsics.size
        self._zero = np.zeros(3)

    def project(self, points: Array) -> Array:
        """Project points of the camera frame, (N, 3) [m] → (N, 2) [px]."""
        projected = cv2.projectPoints(points, self._zero, self._zero, self.matrix, self.distortion)
        return np.asarray(projected[0], np.float64).reshape(-1, 2)

    def project_with_jacobian(self, points: Array) -> tuple[Array, Array]:
        """Project points and say how their pixels move with them, (N, 2) [px], (N, 2, 3) [px/m]."""
        projected, jacobian = cv2.projectPoints(
            points, self._zero, self._zero, self.matrix, self.distortion
        )[:2]
        # Columns 3 to 5 are the slopes by translation, which without rotation are those by the
        # point.
        slopes = np.asarray(jacobian, np.float64)[:, 3:6].reshape(-1, 2, 3)
        return np.asarray(projected, np.float64).reshape(-1, 2), slopes

    def rays(self, pixels: Array) -> Array:
        """Undo the lens: pixels, (N, 2), to points at z = 1 of the camera frame, (N, 2)."""
        points = np.ascontiguousarray(pixels, np.float64).reshape(-1, 1, 2)
        return np.asarray(
            cv2.undistortPoints(points, self.matrix, self.distortion), np.float64
        ).reshape(-1, 2)
