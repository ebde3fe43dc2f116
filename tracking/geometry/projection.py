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
        self._coefficients = np.zeros(8)
        self._coefficients[: len(self.distortion)] = self.distortion
        self._zero = np.zeros(3)

    @property
    def claims_no_distortion(self) -> bool:
        """Whether the lens was never measured, for hardly any bends nothing."""
        return not np.any(self.distortion)

    def project(self, points: Array) -> Array:
        """Project points of the camera frame, (N, 3) [m] → (N, 2) [px].

        `cv2.projectPoints` takes ten times as long, as it always computes a Jacobian. The
        distortion is that of Brown (1971), with OpenCV's coefficients; skew is ignored as there.
        """
        x, y = points[:, 0] / points[:, 2], points[:, 1] / points[:, 2]
        k1, k2, p1, p2, k3, k4, k5, k6 = self._coefficients
        square = x * x + y * y
        radial = 1 + square * (k1 + square * (k2 + square * k3))
        if k4 or k5 or k6:
            radial /= 1 + square * (k4 + square * (k5 + square * k6))
        cross = 2 * x * y
        bent = np.empty((len(points), 2))
        bent[:, 0] = x * radial + p1 * cross + p2 * (square + 2 * x * x)
        bent[:, 1] = y * radial + p2 * cross + p1 * (square + 2 * y * y)
        return np.asarray(bent * self.matrix[[0, 1], [0, 1]] + self.matrix[:2, 2], np.float64)

    def project_with_jacobian(self, points: Array) -> tuple[Array, Array]:
        """Project points: pixels, (N, 2) [px], and their Jacobian, (N, 2, 3) [px/m]."""
        projected, jacobian = cv2.projectPoints(
            points, self._zero, self._zero, self.matrix, self.distortion
        )[:2]
        # Columns 3 to 5 are the Jacobian by translation: without rotation, that by the point.
        by_point = np.asarray(jacobian, np.float64)[:, 3:6].reshape(-1, 2, 3)
        return np.asarray(projected, np.float64).reshape(-1, 2), by_point

    def bends(self, points: Array, centre: Array) -> Array:
        """How radial distortion k1 moves pixels beside that of another point, (N, 2) [px].

        `points` are in the camera frame, (N, 3) [m], and so is `centre`, (3,), whose pixel stays.
        """
        bent = radial_bend(points[:, :2] / points[:, 2:]) - radial_bend(centre[:2] / centre[2])
        return np.asarray(bent * self.matrix[[0, 1], [0, 1]], np.float64)

    def rays(self, pixels: Array) -> Array:
        """Undistort pixels, (N, 2), to points at z = 1 of the camera frame, (N, 2)."""
        points = np.ascontiguousarray(pixels, np.float64).reshape(-1, 1, 2)
        return np.asarray(
            cv2.undistortPoints(points, self.matrix, self.distortion), np.float64
        ).reshape(-1, 2)


def radial_bend(flat: Array) -> Array:
    """How radial distortion k1 moves points at z = 1, (…, 2): the derivative of Brown's model."""
    return np.asarray(flat * (flat * flat).sum(axis=-1, keepdims=True), np.float64)


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
