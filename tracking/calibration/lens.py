"""The camera as nine numbers, and what is known of any camera before it is looked at."""

import cv2
import numpy as np
from numpy.typing import NDArray

from tracking.geometry.intrinsics import Intrinsics

Array = NDArray[np.float64]

PARAMETERS = ("fx", "fy", "cx", "cy", "k1", "k2", "p1", "p2", "k3")
"""Order of the numbers: OpenCV's, as `cv2.projectPoints` gives their slopes."""

PRIOR_CENTRE = 0.04
"""How far the principal point may lie from the middle, one standard deviation [picture widths]."""

PRIOR_LENS = (0.5, 1.0, 0.01, 0.01, 1.0)
"""Sizes of k1 k2 p1 p2 k3 that are usual, one standard deviation."""

PRIOR_SQUARE = 0.01
"""How far fx and fy may differ, one standard deviation: the pixels of today's cameras are square
to better than that."""


def vector(intrinsics: Intrinsics) -> Array:
    """Return the nine numbers of a camera of at most five lens coefficients, (9,)."""
    lens = np.zeros(5)
    lens[: len(intrinsics.distortion)] = intrinsics.distortion
    matrix = intrinsics.matrix
    return np.array([matrix[0, 0], matrix[1, 1], matrix[0, 2], matrix[1, 2], *lens])


def camera(numbers: Array, size: tuple[int, int]) -> Intrinsics:
    """Return the camera that nine numbers describe."""
    fx, fy, cx, cy = numbers[:4]
    return Intrinsics(np.array([[fx, 0, cx], [0, fy, cy], [0, 0, 1]]), numbers[4:], size)


def projected(numbers: Array, points: Array) -> tuple[Array, Array, Array]:
    """Project points of the camera frame.

    Returns
    -------
    Pixels (N, 2), their slopes by the points (N, 2, 3) and by the nine numbers (N, 2, 9).
    """
    fx, fy, cx, cy = numbers[:4]
    matrix = np.array([[fx, 0, cx], [0, fy, cy], [0, 0, 1.0]])
    pixels, slopes = cv2.projectPoints(points, np.zeros(3), np.zeros(3), matrix, numbers[4:])[:2]
    slopes = np.asarray(slopes, np.float64).reshape(-1, 2, slopes.shape[1])
    return np.asarray(pixels, np.float64).reshape(-1, 2), slopes[..., 3:6], slopes[..., 6:15]


def prior(size: tuple[int, int], focal: float, free: NDArray[np.bool_]) -> tuple[Array, Array]:
    """Return what is known beforehand as rows: slopes (M, 9) and values (M,), of unit variance.

    Numbers that are not free are held: they have no row, and their columns are dropped later.
    """
    width, height = size
    rows: list[Array] = []
    values: list[float] = []
    spread = np.array([*[PRIOR_CENTRE * width] * 2, *PRIOR_LENS])
    means = np.array([(width - 1) / 2, (height - 1) / 2, 0, 0, 0, 0, 0])
    for number in range(2, 9):
        if free[number]:
            rows.append(np.eye(9)[number] / spread[number - 2])
            values.append(float(means[number - 2] / spread[number - 2]))
    rows.append((np.eye(9)[0] - np.eye(9)[1]) / (PRIOR_SQUARE * focal))
    values.append(0.0)
    return np.array(rows), np.array(values)
