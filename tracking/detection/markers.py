"""Detection of whole ArUco markers, and which of them are on the cube."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import cv2
import numpy as np

from cubeling.tracking.cube.model import CubeModel, Face, aruco_dictionary
from cubeling.tracking.geometry.arrays import Array, Image


@dataclass(frozen=True)
class Observation:
    """One marker of the cube, detected in an image."""

    face: Face
    """The face of the cube that carries this marker."""

    corners: Array
    """Its corners in the image, (4, 2) [px], in the order of `Face.corners`."""

    @cached_property
    def size(self) -> float:
        """Mean length of the four sides [px]."""
        return float(np.linalg.norm(self.corners - np.roll(self.corners, 1, axis=0), axis=1).mean())


@dataclass(frozen=True)
class Marker:
    """A detected marker, whether it is on a cube or not."""

    marker_id: int
    """Its id in the dictionary."""

    corners: Array
    """As in `Observation.corners`, (4, 2) [px]."""


FIRST_WINDOW_PX, OTHER_WINDOWS_PX = 7, (3, 23)
"""Windows of the local thresholds: the one that finds most markers, and those that find others, of
small markers and in light from one side."""


class MarkerDetector:
    """Detects all markers of one dictionary of OpenCV, such as "DICT_4X4_50".

    A few wrong bits are accepted, by fingers, glare and blur; OpenCV finds markers in clutter then
    (opencv#28953). What it finds is a proposal, to be proved by all cells of the cube.
    """

    def __init__(self, dictionary: str) -> None:
        pattern = aruco_dictionary(dictionary)
        first, last = OTHER_WINDOWS_PX
        self._first = cv2.aruco.ArucoDetector(pattern, _parameters(*[FIRST_WINDOW_PX] * 2))
        self._others = cv2.aruco.ArucoDetector(pattern, _parameters(first, last))
        strict = _parameters(first, last)
        strict.adaptiveThreshWinSizeStep = (last - first) // 2
        # OpenCV's share of the dictionary's correctable bits; 0 takes exact patterns only.
        strict.errorCorrectionRate = 0.0
        self._strict = cv2.aruco.ArucoDetector(pattern, strict)

    def detect(self, grey: Image) -> list[Marker]:
        """Detect markers in a grey image, (H, W), with the window that finds most."""
        return _detect(self._first, grey)

    def detect_others(self, grey: Image) -> list[Marker]:
        """Detect markers with the other windows, some of them again."""
        return _detect(self._others, grey)

    def detect_strictly(self, grey: Image) -> list[Marker]:
        """Detect markers with all windows, and none with a wrong bit: nothing else proves them."""
        return _detect(self._strict, grey)


def _parameters(first: int, last: int) -> cv2.aruco.DetectorParameters:
    parameters = cv2.aruco.DetectorParameters()
    parameters.adaptiveThreshWinSizeMin = first
    parameters.adaptiveThreshWinSizeMax = last
    # One step from the first to the last window; OpenCV asserts that it is positive.
    parameters.adaptiveThreshWinSizeStep = max(last - first, 1)
    parameters.cornerRefinementMethod = cv2.aruco.CORNER_REFINE_SUBPIX
    # The search window must not reach the next edge of a small marker: 0.3 cells, at most 5 px.
    parameters.cornerRefinementWinSize = 5
    parameters.relativeCornerRefinmentWinSize = 0.3
    return parameters


def _detect(detector: cv2.aruco.ArucoDetector, grey: Image) -> list[Marker]:
    quads, ids = detector.detectMarkers(grey)[:2]
    # None where there is no marker; (N,) in OpenCV 5, (N, 1) in OpenCV 4.
    marker_ids = [] if ids is None else [int(number) for number in np.ravel(ids)]
    return [
        Marker(marker_id, np.reshape(quad, (4, 2)).astype(np.float64))
        for marker_id, quad in zip(marker_ids, quads, strict=True)
    ]


def markers_of(cube: CubeModel, markers: Sequence[Marker]) -> list[Observation]:
    """Keep the markers of one cube; `CornerPoseSolver` chooses between two of the same id."""
    faces = {face.marker_id: face for face in cube.faces}
    return [
        Observation(faces[marker.marker_id], marker.corners)
        for marker in markers
        if marker.marker_id in faces
    ]
