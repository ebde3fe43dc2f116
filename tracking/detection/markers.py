"""Markers in a picture: which faces of the cube are seen, and where."""

from collections.abc import Sequence
from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from tracking.cube.model import CubeModel, Face, aruco_dictionary

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Observation:
    """One marker seen in a picture."""

    face: Face
    """The face of the cube that carries this marker."""

    corners: Array
    """Its corners in the picture, (4, 2) [px], in the order of `Face.corners`."""

    @property
    def size(self) -> float:
        """Mean length of the four sides [px]."""
        return float(np.linalg.norm(self.corners - np.roll(self.corners, 1, axis=0), axis=1).mean())


@dataclass(frozen=True)
class Marker:
    """A marker of some cube, or of none."""

    number: int
    """Its number in the dictionary."""

    corners: Array
    """As in `Observation.corners`, (4, 2) [px]."""


class MarkerDetector:
    """Finds all markers of one dictionary.

    Parameters
    ----------
    dictionary
        Name of the OpenCV dictionary, "DICT_4X4_50" …
    """

    def __init__(self, dictionary: str) -> None:
        parameters = cv2.aruco.DetectorParameters()
        # Not one wrong bit: with 6 of 50 ids wanted, OpenCV's default of 0.6 finds markers in
        # clutter (opencv#28953).
        parameters.errorCorrectionRate = 0.0
        parameters.cornerRefinementMethod = cv2.aruco.CORNER_REFINE_SUBPIX
        # The search window must not reach the next edge of a small marker: 0.3 of a cell, at most 5
        # px.
        parameters.cornerRefinementWinSize = 5
        parameters.relativeCornerRefinmentWinSize = 0.3
        # Enough for light from one side: local thresholds over 3, 13 and 23 px.
        parameters.adaptiveThreshWinSizeMin = 3
        parameters.adaptiveThreshWinSizeMax = 23
        parameters.adaptiveThreshWinSizeStep = 10
        self._detector = cv2.aruco.ArucoDetector(aruco_dictionary(dictionary), parameters)

    def detect(self, grey: NDArray[np.uint8]) -> list[Marker]:
        """Find markers in a grey picture, (H, W)."""
        squares, ids = self._detector.detectMarkers(grey)[:2]
        # None where there is no marker; (N,) in OpenCV 5, (N, 1) in OpenCV 4.
        numbers = [] if ids is None else [int(number) for number in np.ravel(ids)]
        return [
            Marker(number, np.reshape(square, (4, 2)).astype(np.float64))
            for number, square in zip(numbers, squares, strict=True)
        ]


def observed(cube: CubeModel, markers: Sequence[Marker]) -> list[Observation]:
    """Keep the markers of one cube.

    A marker can be seen twice: which of the two is the cube's is for `solver` to say.
    """
    faces = {face.marker_id: face for face in cube.faces}
    return [
        Observation(faces[marker.number], marker.corners)
        for marker in markers
        if marker.number in faces
    ]
