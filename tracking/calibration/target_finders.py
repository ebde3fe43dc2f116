"""Finding the calibration target in an image: a cube or a ChArUco board."""

from dataclasses import dataclass
from typing import Protocol

import cv2
import numpy as np

from cubeling.tracking.calibration.board import Board
from cubeling.tracking.calibration.marker_edges import MarkerEdgeMeter
from cubeling.tracking.calibration.model import CalibrationTarget
from cubeling.tracking.calibration.view import View, join_views, view_of_corners
from cubeling.tracking.cube.model import CubeModel
from cubeling.tracking.detection.markers import MarkerDetector, Observation, markers_of
from cubeling.tracking.geometry.arrays import Array, Image
from cubeling.tracking.geometry.image_region import Patch

MIN_CORNERS = 8
"""Minimum number of detected corners of a board."""


@dataclass(frozen=True)
class TargetDetection:
    """A target in one image, accurate to about a pixel."""

    corners: View
    """Its corners in the picture with their places on the target."""

    outlines: tuple[Array, ...]
    """Outline of each visible plate, each (4, 2) [px]."""

    plates: tuple[int, ...]
    """Index of the plate of each outline."""

    observations: tuple[Observation, ...] = ()
    """The markers, if the target is a cube."""


class TargetFinder(Protocol):
    """Finds and measures one kind of target."""

    names: tuple[str, ...]
    """Names of the plates."""

    def find(self, grey: Image, timestamp: float) -> TargetDetection | None:
        """Detect the target in a grey image, (H, W)."""
        ...

    def measure(self, grey: Image, found: TargetDetection) -> View | None:
        """Measure a detected target precisely; None if it is not clearly visible."""
        ...

    def target(self, size: tuple[int, int]) -> CalibrationTarget:
        """Describe the target, for images of a size."""
        ...


class CubeFinder:
    """Finds the markers of a cube and measures their edges."""

    def __init__(self, cube: CubeModel) -> None:
        self.cube = cube
        self.names = tuple(face.name for face in cube.faces)
        self._detector = MarkerDetector(cube.dictionary)
        self._meter = MarkerEdgeMeter(cube)

    def find(self, grey: Image, timestamp: float) -> TargetDetection | None:
        """Detect the markers; the larger one of two with the same id counts."""
        largest: dict[str, Observation] = {}
        for seen in markers_of(self.cube, self._detector.detect_strictly(grey)):
            other = largest.get(seen.face.name)
            if other is None or seen.size > other.size:
                largest[seen.face.name] = seen
        if not largest:
            return None
        plates = tuple(self.names.index(name) for name in largest)
        outlines = tuple(seen.corners for seen in largest.values())
        corners = view_of_corners(
            timestamp,
            np.repeat(np.array(plates), 4),
            np.concatenate([seen.face.corners for seen in largest.values()]),
            np.concatenate(outlines),
        )
        return TargetDetection(corners, outlines, plates, tuple(largest.values()))

    def measure(self, grey: Image, found: TargetDetection) -> View | None:
        """Measure all edges of all detected markers."""
        time, patch = found.corners.timestamp, Patch.crop(grey)
        parts = [self._meter.measure(patch, seen, time) for seen in found.observations]
        good = [part for part in parts if part is not None]
        return join_views(time, good) if good else None

    def target(self, size: tuple[int, int]) -> CalibrationTarget:
        """Describe the cube: six plates that may be off their nominal poses."""
        centres = np.stack([face.corners.mean(axis=0) for face in self.cube.faces])
        return CalibrationTarget(size, np.ones(9, np.bool_), centres, len(self.names) > 1)


class BoardFinder:
    """Finds the inner corners of a ChArUco board."""

    names: tuple[str, ...] = ("board",)

    def __init__(self, board: Board) -> None:
        self.board = board
        self._detector = cv2.aruco.CharucoDetector(board.pattern)

    def find(self, grey: Image, timestamp: float) -> TargetDetection | None:
        """Detect the corners; None if they are too few or all on one line."""
        corners, ids = self._detector.detectBoard(grey)[:2]
        # OpenCV returns None if there is no board.
        pixels = np.reshape([] if corners is None else corners, (-1, 2)).astype(np.float64)
        points = self.board.points[np.ravel([] if ids is None else ids).astype(np.intp)]
        if len(pixels) < MIN_CORNERS:
            return None
        if np.linalg.matrix_rank(points[:, :2] - points[0, :2], tol=1e-6) < 2:
            return None
        homography = np.asarray(cv2.findHomography(points[:, :2], pixels)[0], np.float64)
        outline = cv2.perspectiveTransform(self.board.outline[:, None, :2], homography)
        view = view_of_corners(timestamp, np.zeros(len(pixels), np.intp), points, pixels)
        return TargetDetection(view, (np.asarray(outline, np.float64).reshape(4, 2),), (0,))

    def measure(self, grey: Image, found: TargetDetection) -> View | None:
        """Return the corners: two edges cross in each, so blur and gamma cancel out."""
        return found.corners

    def target(self, size: tuple[int, int]) -> CalibrationTarget:
        """Describe the board: a single plate of fixed shape."""
        centre = self.board.points.mean(axis=0)[None]
        return CalibrationTarget(size, np.ones(9, np.bool_), centre, adjust_plates=False)
