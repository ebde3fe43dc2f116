"""A camera as a vector of nine parameters, its projection with derivatives, and its prior.

The parameters are fx fy cx cy k1 k2 p1 p2 k3, as in the Jacobian of `cv2.projectPoints`.
"""

import cv2
import numpy as np

from cubeling.tracking.geometry.arrays import Array, Flags
from cubeling.tracking.geometry.intrinsics import Intrinsics
from cubeling.tracking.geometry.projection import Projection

CENTRE_SIGMA = 0.04
"""Prior standard deviation of the principal point about the image centre [image widths]."""

DISTORTION_SIGMAS = (0.5, 1.0, 0.01, 0.01, 1.0)
"""Prior standard deviations of k1 k2 p1 p2 k3 about zero."""

ASPECT_SIGMA = 0.01
"""Prior standard deviation of fx / fy about 1: today's cameras have square pixels."""


def from_intrinsics(intrinsics: Intrinsics) -> Array:
    """Return the parameters (9,) of a camera with at most five distortion coefficients."""
    distortion = np.zeros(5)
    distortion[: len(intrinsics.distortion)] = intrinsics.distortion
    matrix = intrinsics.matrix
    return np.array([matrix[0, 0], matrix[1, 1], matrix[0, 2], matrix[1, 2], *distortion])


def to_intrinsics(camera: Array, size: tuple[int, int]) -> Intrinsics:
    """Return the camera with the given parameters (9,) and image size [px]."""
    return Intrinsics(_matrix(camera), camera[4:], size)


def _matrix(camera: Array) -> Array:
    fx, fy, cx, cy = camera[:4]
    return np.array([[fx, 0, cx], [0, fy, cy], [0, 0, 1.0]])


def project(camera: Array, points: Array) -> Array:
    """Project points of the camera frame, (N, 3) [m] → (N, 2) [px]."""
    return Projection(to_intrinsics(camera, (1, 1))).project(points)


def project_with_jacobian(camera: Array, points: Array) -> tuple[Array, Array, Array]:
    """Project points of the camera frame, (N, 3) [m].

    Returns
    -------
    Pixels (N, 2), and their derivatives by the points (N, 2, 3) and by the parameters (N, 2, 9).
    """
    zero = np.zeros(3)
    pixels, jacobian = cv2.projectPoints(points, zero, zero, _matrix(camera), camera[4:])[:2]
    jacobian = np.asarray(jacobian, np.float64).reshape(-1, 2, jacobian.shape[1])
    return np.asarray(pixels, np.float64).reshape(-1, 2), jacobian[..., 3:6], jacobian[..., 6:15]


def prior(size: tuple[int, int], focal: float, free: Flags) -> tuple[Array, Array]:
    """Return the prior as linear equations of unit variance: rows (M, 9) and values (M,).

    Parameters that are not free have no equation; the solver drops their columns.
    """
    width, height = size
    sigmas = np.array([*[CENTRE_SIGMA * width] * 2, *DISTORTION_SIGMAS])
    means = np.array([(width - 1) / 2, (height - 1) / 2, 0, 0, 0, 0, 0])
    rows = (np.eye(9)[2:] / sigmas[:, None])[free[2:]]
    aspect = (np.eye(9)[0] - np.eye(9)[1]) / (ASPECT_SIGMA * focal)
    return np.vstack([rows, aspect]), np.append((means / sigmas)[free[2:]], 0.0)
