"""Projection of points to pixels through the lens, and back."""

from collections.abc import Iterator

import cv2
import numpy as np

from tracking.geometry import se3
from tracking.geometry.arrays import Array
from tracking.geometry.intrinsics import Intrinsics

MIN_DEPTH = 0.03
"""A cube closer to the camera than this [m] is not seen whole; such a pose is wrong."""


class Projection:
    """A pinhole camera with any distortion model of OpenCV; pixel centres at whole numbers."""

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
        """Project points: pixels, (N, 2) [px], and their Jacobian, (N, 2, 3) [px/m]."""
        projected, jacobian = cv2.projectPoints(
            points, self._zero, self._zero, self.matrix, self.distortion
        )[:2]
        # Columns 3 to 5 are the Jacobian by translation: without rotation, that by the point.
        by_point = np.asarray(jacobian, np.float64)[:, 3:6].reshape(-1, 2, 3)
        return np.asarray(projected, np.float64).reshape(-1, 2), by_point

    def rays(self, pixels: Array) -> Array:
        """Undistort pixels, (N, 2), to points at z = 1 of the camera frame, (N, 2)."""
        points = np.ascontiguousarray(pixels, np.float64).reshape(-1, 1, 2)
        return np.asarray(
            cv2.undistortPoints(points, self.matrix, self.distortion), np.float64
        ).reshape(-1, 2)


def planar_poses(points: Array, rays: Array, method: int) -> Iterator[Array]:
    """Yield the poses of flat points, (4, 4) each: two, as far as they are finite.

    `points` are in the plane's frame, (N, 3) [m], `rays` where they are seen, at z = 1 of the
    camera frame, (N, 2). `method` is OpenCV's: `SOLVEPNP_IPPE`, or `SOLVEPNP_IPPE_SQUARE` for the
    corners of a square about the origin (Collins and Bartoli, 2014).
    """
    found, turns, origins = cv2.solvePnPGeneric(points, rays, np.eye(3), None, flags=method)[:3]
    for turn, origin in zip(turns, origins, strict=True) if found else ():
        vectors = np.array([turn, origin], np.float64).reshape(2, 3)
        if np.isfinite(vectors).all():
            yield se3.pose(se3.rotation(vectors[0]), vectors[1])
