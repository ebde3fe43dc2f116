"""The camera's frame as an ideal pinhole camera of the picture's size would have taken it."""

from concurrent.futures import Future, ThreadPoolExecutor, wait

import cv2
import numpy as np
from numpy.typing import NDArray

from cubeling.characters.errors import CharacterError
from cubeling.characters.rendering.camera_picture.hand_cover import Maps, PictureCover, covered_area
from cubeling.characters.rendering.projection import Rectangle, is_pinhole, usable_distortion
from cubeling.characters.rendering.scene import CameraView, HandInFront
from cubeling.characters.skeleton.pose import Array

Image = NDArray[np.uint8]

BACKDROP_TOP_BGR, BACKDROP_BOTTOM_BGR = (226.0, 224.0, 222.0), (176.0, 180.0, 186.0)
"""Colours of the plain backdrop."""

_STEPS = np.linspace(0.0, 1.0, 5)
_RIM = np.array([(x, y) for x in _STEPS for y in _STEPS if x in (0, 1) or y in (0, 1)])
"""Points along the rim of a unit square, (n, 2): a lens bends its sides."""


class Undistorter:
    """Undistorts camera frames, and fits them to the size of the picture.

    The maps of `cv2.remap` are computed once for each camera. The frame is remapped with four
    channels, the last unused: OpenCV has a fast path for four that is twice as fast as the one for
    three, both conversions included. `size` is that of the picture, (width, height) [px].
    """

    def __init__(self, size: tuple[int, int]) -> None:
        self._size = size
        self._camera_key: tuple[bytes, ...] = ()
        self._maps: Maps | None = None
        self._bgra = np.empty((0, 0, 4), np.uint8)
        self._undistorted_bgra = np.empty((size[1], size[0], 4), np.uint8)
        self._matrix = np.eye(3)
        self._lens = np.eye(3), np.zeros(5)
        self._backdrop: Image | None = None
        self._worker: ThreadPoolExecutor | None = None
        self._ahead: tuple[CameraView, Future[Image]] | None = None

    def start(self, image: Image, matrix: Array, distortion: Array) -> None:
        """Begin to undistort a frame on another thread: its view follows.

        OpenCV leaves the interpreter to others meanwhile, and the tracker seldom needs all cores.
        A view of another frame or camera is undistorted as if this had not been called.
        """
        self._finish()
        if not _is_frame(image):
            return  # `undistort` says so
        if self._worker is None:
            self._worker = ThreadPoolExecutor(1, "undistortion")
        view = CameraView(image, matrix, distortion, None)
        self.matrix_of(view)
        self._ahead = view, self._worker.submit(self._undistort, view, self._maps)

    def _finish(self) -> None:
        """Wait for the other thread: the buffers are in use until then."""
        if self._ahead is not None:
            wait([self._ahead[1]])
            self._ahead = None

    def release(self) -> None:
        """End the other thread; a second call does nothing."""
        self._finish()
        if self._worker is not None:
            self._worker.shutdown()
            self._worker = None

    def matrix_of(self, view: CameraView) -> Array:
        """Return the pinhole matrix of the picture, (3, 3) [px], without waiting for the picture.

        Raises
        ------
        CharacterError
            The view's image is not (height, width, 3) uint8.
        """
        if view.image is None:
            return np.asarray(view.matrix, float)
        image = _check(view.image)
        if not is_pinhole(view.matrix):
            return np.eye(3)
        camera_key = _camera_key(view)
        if camera_key != self._camera_key:
            matrix = np.asarray(view.matrix, float)
            distortion = usable_distortion(view.distortion)
            frame_size = (image.shape[1], image.shape[0])
            self._matrix, self._maps = self._make_maps(matrix, distortion, frame_size, view.part)
            self._camera_key = camera_key
            self._lens = matrix, distortion
        return self._matrix

    def undistort(self, view: CameraView) -> Image:
        """Return the undistorted picture, (height, width, 3) BGR: a copy to draw on.

        Raises
        ------
        CharacterError
            The view's image is not (height, width, 3) uint8.
        """
        if view.image is None:
            return self._plain_backdrop()
        ahead = self._ahead
        self._finish()
        if ahead is not None and _same_picture(ahead[0], view):
            return ahead[1].result()
        self.matrix_of(view)
        return self._undistort(view, self._maps)

    def _undistort(self, view: CameraView, maps: Maps | None) -> Image:
        """Return the same, of a view that has an image, by the maps of its camera."""
        image = view.image
        assert image is not None
        if not is_pinhole(view.matrix):
            return self._fit(image, (image.shape[1], image.shape[0]))
        return image.copy() if maps is None else self._remap(image, *maps)

    def cover_in_picture(self, hand: HandInFront) -> PictureCover | None:
        """Return the hand in the last view's frame as it is in the picture, or None outside of it.

        It has an empty rim, so that it ends softly.
        """
        covered = covered_area(hand)
        if not covered.width:
            return None
        area = self._area_in_picture(covered).intersection(Rectangle(0, 0, *self._size))
        return None if area is None else PictureCover(area, hand, self._maps)

    def _area_in_picture(self, part: Rectangle) -> Rectangle:
        """Return the area of the picture around a rectangle of the last view's frame."""
        columns, rows = part.x + part.width * _RIM[:, 0], part.y + part.height * _RIM[:, 1]
        points = np.stack([columns, rows], axis=1)[:, None]
        if self._maps is not None:
            points = cv2.undistortPoints(points, *self._lens, P=self._matrix)
        low = np.floor(points.min((0, 1))).astype(int) - 2
        high = np.ceil(points.max((0, 1))).astype(int) + 3
        return Rectangle(int(low[0]), int(low[1]), *(high - low).tolist())

    def _remap(
        self, image: Image, columns: NDArray[np.float32], rows: NDArray[np.float32]
    ) -> Image:
        """Return a picture whose pixels come from the given columns and rows of the frame."""
        if self._bgra.shape[:2] != image.shape[:2]:
            self._bgra = np.empty((*image.shape[:2], 4), np.uint8)
        cv2.cvtColor(image, cv2.COLOR_BGR2BGRA, dst=self._bgra)
        cv2.remap(
            self._bgra,
            columns,
            rows,
            interpolation=cv2.INTER_LINEAR,
            dst=self._undistorted_bgra,
            borderMode=cv2.BORDER_REFLECT_101,
        )
        return np.asarray(cv2.cvtColor(self._undistorted_bgra, cv2.COLOR_BGRA2BGR), np.uint8)

    def _make_maps(
        self,
        matrix: Array,
        distortion: Array,
        frame_size: tuple[int, int],
        part: tuple[float, float, float, float] | None,
    ) -> tuple[Array, Maps | None]:
        """Return the picture's matrix and, if it needs any, the maps from it to the frame."""
        if part is not None:
            left, top, right, bottom = part
            corner = np.array([[1.0, 0.0, -left], [0.0, 1.0, -top], [0.0, 0.0, 1.0]])
            fitted = _fit((right - left, bottom - top), self._size) @ corner @ matrix
        elif distortion.any() or frame_size != self._size:
            fitted = _fit(frame_size, self._size) @ matrix
        else:
            return matrix, None
        columns, rows = cv2.initUndistortRectifyMap(
            matrix,
            distortion,
            np.eye(3),
            fitted,
            self._size,
            cv2.CV_32FC1,
        )
        return fitted, (np.asarray(columns, np.float32), np.asarray(rows, np.float32))

    def _fit(self, image: Image, frame_size: tuple[int, int]) -> Image:
        """Scale a frame of an unknown camera to the picture."""
        if frame_size == self._size:
            return image.copy()
        fit = _fit(frame_size, self._size)[:2]
        return np.asarray(cv2.warpAffine(image, fit, self._size, flags=cv2.INTER_LINEAR), np.uint8)

    def _plain_backdrop(self) -> Image:
        """Return a light backdrop for pictures without a camera, darker towards the bottom."""
        if self._backdrop is None:
            width, height = self._size
            share = np.linspace(0.0, 1.0, height)[:, None, None] ** 1.5
            top, bottom = np.array(BACKDROP_TOP_BGR), np.array(BACKDROP_BOTTOM_BGR)
            rows = (top + (bottom - top) * share).round().astype(np.uint8)
            self._backdrop = np.ascontiguousarray(np.broadcast_to(rows, (height, width, 3)))
        return self._backdrop.copy()


def _camera_key(view: CameraView) -> tuple[bytes, ...]:
    """Return what the maps of a view depend on."""
    matrix = np.asarray(view.matrix, float)
    shape = None if view.image is None else view.image.shape[:2]
    distortion = usable_distortion(view.distortion)
    return matrix.tobytes(), distortion.tobytes(), bytes(repr((shape, view.part)), "ascii")


def _same_picture(view: CameraView, other: CameraView) -> bool:
    """Return whether two views show the same picture."""
    return view.image is other.image and _camera_key(view) == _camera_key(other)


def _is_frame(image: Image) -> bool:
    shape = image.shape
    return len(shape) == 3 and shape[2] == 3 and image.dtype == np.uint8 and 0 not in shape


def _check(image: Image) -> Image:
    if not _is_frame(image):
        raise CharacterError(
            f"cannot draw on an image of shape {image.shape} and type {image.dtype}: "
            "it must be (height, width, 3) uint8, BGR"
        )
    return image


def _fit(frame_size: tuple[float, float], picture_size: tuple[int, int]) -> Array:
    """Return the map of pixels (3, 3) that centres a whole frame in the picture, unstretched.

    >>> _fit((64, 48), (128, 96)) @ [-0.5, -0.5, 1]
    array([-0.5, -0.5,  1. ])
    """
    scale = min(picture_size[0] / frame_size[0], picture_size[1] / frame_size[1])
    shift = (np.array(picture_size) - scale * np.array(frame_size)) / 2 + 0.5 * scale - 0.5
    return np.array([[scale, 0.0, shift[0]], [0.0, scale, shift[1]], [0.0, 0.0, 1.0]])
