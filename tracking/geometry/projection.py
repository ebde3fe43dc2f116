"""Projection of points to pixels through the lens, and back."""

from collections.abc import Iterator

import cv2
import numpy as np

from cubeling.tracking.geometry import se3
from cubeling.tracking.geometry.arrays import Array
from cubeling.tracking.geometry.intrinsics import Intrinsics

MIN_DEPTH = 0.03
"""A cube closer to the camera than this [m] is not seen whole; such a pose is wrong."""


class Projection:
    """A pinhole camera with any distortion model of OpenCV; pixel centres at whole numbers."""

    def __init__(self, intrinsics: Intrinsics) -> None:
        self.intrinsics = intrinsics
        self.matrix = np.asarray(intrinsics.matrix, np.float64)
        self.distortion = np.asarray(intrinsics.distortion, np.float64).ravel()
        self.size = intrinsics.size
        self.claims_no_distortion = not np.any(self.distortion)
        """Whether the lens was never measured, for hardly any bends nothing."""
        coefficients = [*self.distortion.tolist(), *[0.0] * 8][:8]
        self._k1, self._k2, self._p1, self._p2, self._k3, *self._divisor = coefficients
        (self._fx, _, self._cx), (_, self._fy, self._cy) = self.matrix[:2].tolist()

    def project(self, points: Array) -> Array:
        """Project points of the camera frame, (N, 3) [m] → (N, 2) [px].

        The distortion is that of Brown (1971), with OpenCV's coefficients; skew is ignored as
        there. `cv2.projectPoints` takes ten times as long, as it always computes a Jacobian.
        """
        x, y = points[:, 0] / points[:, 2], points[:, 1] / points[:, 2]
        if self.claims_no_distortion:
            return self._pinhole(x, y)
        square = x * x + y * y
        return self._pixels(x, y, square, self._radial(square))

    def project_with_jacobian(self, points: Array) -> tuple[Array, Array]:
        """Project points: pixels, (N, 2) [px], and their Jacobian, (N, 2, 3) [px/m].

        Each component of both is contiguous, as numpy takes several times as long over short rows.
        """
        near = 1 / points[:, 2]
        x, y = points[:, 0] * near, points[:, 1] * near
        if self.claims_no_distortion:  # the same numbers in half the time
            jacobian = np.zeros((2, 3, len(x)))
            np.multiply(self._fx, near, out=jacobian[0, 0])
            np.multiply(self._fy, near, out=jacobian[1, 1])
            np.multiply(-x, jacobian[0, 0], out=jacobian[0, 2])
            np.multiply(-y, jacobian[1, 1], out=jacobian[1, 2])
            return self._pinhole(x, y), jacobian.transpose(2, 0, 1)
        square = x * x + y * y
        radial = self._radial(square)
        slope = self._radial_slope(square, radial)
        mixed = x * y * slope + self._p1 * x + self._p2 * y  # half the change of u by y, of v by x
        by_flat = np.empty((2, 2, len(x)))
        by_flat[0, 0] = radial + 2 * (x * x * slope + self._p1 * y + 3 * self._p2 * x)
        by_flat[1, 1] = radial + 2 * (y * y * slope + self._p2 * x + 3 * self._p1 * y)
        by_flat[0, 1] = by_flat[1, 0] = 2 * mixed
        by_flat[0] *= self._fx * near
        by_flat[1] *= self._fy * near
        jacobian = np.empty((2, 3, len(x)))
        jacobian[:, :2] = by_flat
        jacobian[:, 2] = -(x * by_flat[:, 0] + y * by_flat[:, 1])
        return self._pixels(x, y, square, radial), jacobian.transpose(2, 0, 1)

    def _radial(self, square: Array) -> Array:
        """Return the radial factor at squared distances from the axis."""
        factor = 1 + square * (self._k1 + square * (self._k2 + square * self._k3))
        return factor / self._divide(square) if any(self._divisor) else factor

    def _radial_slope(self, square: Array, factor: Array) -> Array:
        """Return how that factor changes by squared distances."""
        slope = self._k1 + square * (2 * self._k2 + 3 * self._k3 * square)
        if not any(self._divisor):
            return slope
        k4, k5, k6 = self._divisor
        return (slope - factor * (k4 + square * (2 * k5 + 3 * k6 * square))) / self._divide(square)

    def _divide(self, square: Array) -> Array:
        k4, k5, k6 = self._divisor
        return 1 + square * (k4 + square * (k5 + square * k6))

    def _pinhole(self, x: Array, y: Array) -> Array:
        pixels = np.empty((2, len(x)))
        pixels[0] = x * self._fx + self._cx
        pixels[1] = y * self._fy + self._cy
        return pixels.T

    def _pixels(self, x: Array, y: Array, square: Array, radial: Array) -> Array:
        cross, p1, p2 = 2 * x * y, self._p1, self._p2
        pixels = np.empty((2, len(x)))
        pixels[0] = (x * radial + p1 * cross + p2 * (square + 2 * x * x)) * self._fx + self._cx
        pixels[1] = (y * radial + p2 * cross + p1 * (square + 2 * y * y)) * self._fy + self._cy
        return pixels.T

    def bends(self, points: Array, centre: Array) -> Array:
        """How radial distortion k1 moves pixels beside that of another point, (N, 2) [px].

        `points` are in the camera frame, (N, 3) [m], and so is `centre`, (3,), whose pixel stays.
        """
        bent = radial_bend(points[:, :2] / points[:, 2:]) - radial_bend(centre[:2] / centre[2])
        return np.asarray(bent * (self._fx, self._fy), np.float64)

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
