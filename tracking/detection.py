"""Markers in a picture: which faces of the cube are seen, and where."""

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from tracking.cube import CubeModel, Face, aruco_dictionary
from tracking.patch import Patch

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


class MarkerDetector:
    """Finds the markers of one cube, and no others of its dictionary."""

    def __init__(self, cube: CubeModel) -> None:
        self._faces = {face.marker_id: face for face in cube.faces}
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
        self._detector = cv2.aruco.ArucoDetector(aruco_dictionary(cube.dictionary), parameters)

    def detect(self, patch: Patch) -> list[Observation]:
        """Find the cube's markers in a picture.

        A marker can be seen twice: which of the two is the cube's is for `solver` to say.
        """
        squares, ids = self._detector.detectMarkers(patch.grey.astype(np.uint8))[:2]
        # None where there is no marker; (N,) in OpenCV 5, (N, 1) in OpenCV 4.
        numbers = [] if ids is None else [int(number) for number in np.ravel(ids)]
        corner = np.array([patch.left, patch.top], np.float64)
        return [
            Observation(self._faces[number], np.reshape(square, (4, 2)) + corner)
            for number, square in zip(numbers, squares, strict=True)
            if number in self._faces
        ]
