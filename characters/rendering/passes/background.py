"""The camera's frame as an ideal pinhole camera would have taken it."""

import cv2
import numpy as np
from numpy.typing import NDArray

from characters.errors import CharacterError
from characters.rendering.projection import is_pinhole
from characters.rendering.scene import View

Array = NDArray[np.float64]
Image = NDArray[np.uint8]


class Background:
    """Straightens camera frames, and fits them to the size of the picture.

    The maps of `cv2.remap` are computed once a camera. It is given four channels, the last unused:
    OpenCV has a fast path for those, twice as fast as that for three even with both conversions.

    Parameters
    ----------
    size
        Of the picture, (width, height) [px].
    """

    def __init__(self, size: tuple[int, int]) -> None:
        self._size = size
        self._camera: tuple[bytes, ...] = ()
        self._maps: tuple[NDArray[np.float32], NDArray[np.float32]] | None = None
        self._wide = np.empty((0, 0, 4), np.uint8)
        self._wide_straight = np.empty((size[1], size[0], 4), np.uint8)
        self._matrix = np.eye(3)
        self._backdrop: Image | None = None

    def of(self, view: View) -> tuple[Image, Array]:
        """Return the straight picture, (height, width, 3) BGR, and its pinhole matrix (3, 3).

        The picture is the caller's to draw on.
        """
        if view.image is None:
            return self._plain(), np.asarray(view.matrix, float)
        image = _checked(view.image)
        frame = (image.shape[1], image.shape[0])
        if not is_pinhole(view.matrix):
            return self._fitted(image, frame), np.eye(3)
        matrix = np.asarray(view.matrix, float)
        distortion = np.asarray(view.distortion, float).ravel()
        camera = (matrix.tobytes(), distortion.tobytes(), bytes(repr(frame), "ascii"))
        if camera != self._camera:
            self._matrix, self._maps = self._maps_of(matrix, distortion, frame)
            self._camera = camera
        if self._maps is None:
            return image.copy(), self._matrix
        return self._straightened(image, *self._maps), self._matrix

    def _straightened(
        self, image: Image, columns: NDArray[np.float32], rows: NDArray[np.float32]
    ) -> Image:
        """Return a picture that takes each pixel from some column and row of the frame."""
        if self._wide.shape[:2] != image.shape[:2]:
            self._wide = np.empty((*image.shape[:2], 4), np.uint8)
        cv2.cvtColor(image, cv2.COLOR_BGR2BGRA, dst=self._wide)
        cv2.remap(
            self._wide,
            columns,
            rows,
            interpolation=cv2.INTER_LINEAR,
            dst=self._wide_straight,
            borderMode=cv2.BORDER_REFLECT_101,
        )
        return np.asarray(cv2.cvtColor(self._wide_straight, cv2.COLOR_BGRA2BGR), np.uint8)

    def _maps_of(
        self, matrix: Array, distortion: Array, frame: tuple[int, int]
    ) -> tuple[Array, tuple[NDArray[np.float32], NDArray[np.float32]] | None]:
        """Return the matrix of the picture and the maps from it to the frame, if any are needed."""
        bent = bool(
            distortion.size in (4, 5, 8, 12, 14)
            and np.isfinite(distortion).all()
            and distortion.any()
        )
        if not bent and frame == self._size:
            return matrix, None
        fitted = _fit(frame, self._size) @ matrix
        columns, rows = cv2.initUndistortRectifyMap(
            matrix,
            distortion if bent else np.zeros(5),
            np.eye(3),
            fitted,
            self._size,
            cv2.CV_32FC1,
        )
        return fitted, (np.asarray(columns, np.float32), np.asarray(rows, np.float32))

    def _fitted(self, image: Image, frame: tuple[int, int]) -> Image:
        """Scale a frame of an unknown camera to the picture."""
        if frame == self._size:
            return image.copy()
        return np.asarray(
            cv2.warpAffine(image, _fit(frame, self._size)[:2], self._size, flags=cv2.INTER_LINEAR),
            np.uint8,
        )

    def _plain(self) -> Image:
        """Return a light backdrop for pictures without a camera, darker at its foot."""
        if self._backdrop is None:
            width, height = self._size
            shade = np.linspace(0.0, 1.0, height)[:, None, None] ** 1.5
            top, foot = np.array([226.0, 224.0, 222.0]), np.array([176.0, 180.0, 186.0])
            rows = (top + (foot - top) * shade).round().astype(np.uint8)
            self._backdrop = np.ascontiguousarray(np.broadcast_to(rows, (height, width, 3)))
        return self._backdrop.copy()


def _checked(image: Image) -> Image:
    if image.ndim != 3 or image.shape[2] != 3 or image.dtype != np.uint8 or 0 in image.shape:
        raise CharacterError(
            f"cannot draw on an image of shape {image.shape} and type {image.dtype}: "
            "it must be (height, width, 3) uint8, BGR"
        )
    return image


def _fit(frame: tuple[int, int], picture: tuple[int, int]) -> Array:
    """Return the map of pixels (3, 3) that centres a frame in the picture, whole and not stretched.

    >>> _fit((64, 48), (128, 96)) @ [-0.5, -0.5, 1]
    array([-0.5, -0.5,  1. ])
    """
    scale = min(picture[0] / frame[0], picture[1] / frame[1])
    shift = (np.array(picture) - scale * np.array(frame)) / 2 + 0.5 * scale - 0.5
    return np.array([[scale, 0.0, shift[0]], [0.0, scale, shift[1]], [0.0, 0.0, 1.0]])
