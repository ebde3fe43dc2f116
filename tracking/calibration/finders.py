"""Finding what is held before the camera: the cube, or a ChArUco board."""

from dataclasses import dataclass
from typing import Protocol

import cv2
import numpy as np
from numpy.typing import NDArray

from tracking.calibration.board import Board
from tracking.calibration.markers import EdgeMeter
from tracking.calibration.solving import target_of
from tracking.calibration.unknowns import Setting
from tracking.calibration.view import View, joined, of_corners
from tracking.cube.model import CubeModel
from tracking.detection.markers import MarkerDetector, Observation, observed
from tracking.geometry.image_region import Patch

Array = NDArray[np.float64]
Grey = NDArray[np.uint8]


@dataclass(frozen=True)
class Found:
    """A target in one picture, to the nearest pixel or so."""

    corners: View
    """Its corners."""

    outlines: tuple[Array, ...]
    """Outline of each plate in the picture, each (4, 2) [px]."""

    plates: tuple[int, ...]
    """Number of the plate of each outline."""

    observations: tuple[Observation, ...] = ()
    """The markers, where the target is a cube."""


class Finder(Protocol):
    """Finds one kind of target."""

    names: tuple[str, ...]
    """What the plates are called."""

    def find(self, grey: Grey, timestamp: float) -> Found | None:
        """Find the target in a grey picture, (H, W)."""
        ...

    def measure(self, grey: Grey, found: Found) -> View | None:
        """Measure as well as can be what was found; None where it cannot be seen well."""
        ...

    def target(self, size: tuple[int, int]) -> Setting:
        """Describe the target, for pictures of a size."""
        ...


class CubeFinder:
    """Finds the markers of a cube, and measures their edges."""

    def __init__(self, cube: CubeModel) -> None:
        self.cube = cube
        self.names = tuple(face.name for face in cube.faces)
        self._numbers = {name: number for number, name in enumerate(self.names)}
        self._detector = MarkerDetector(cube.dictionary)
        self._meter = EdgeMeter(cube)

    def find(self, grey: Grey, timestamp: float) -> Found | None:
        """Find markers; of two with one id the larger is taken."""
        largest: dict[str, Observation] = {}
        for seen in observed(self.cube, self._detector.detect(grey)):
            other = largest.get(seen.face.name)
            if other is None or seen.size > other.size:
                largest[seen.face.name] = seen
        if not largest:
            return None
        plates = tuple(self._numbers[name] for name in largest)
        corners = of_corners(
            timestamp,
            np.repeat(np.array(plates), 4),
            np.concatenate([seen.face.corners for seen in largest.values()]),
            np.concatenate([seen.corners for seen in largest.values()]),
        )
        outlines = tuple(seen.corners for seen in largest.values())
        return Found(corners, outlines, plates, tuple(largest.values()))

    def measure(self, grey: Grey, found: Found) -> View | None:
        """Measure all edges of all markers."""
        time, patch = found.corners.timestamp, Patch.of(grey)
        parts = [self._meter.measure(patch, seen, time) for seen in found.observations]
        good = [part for part in parts if part is not None]
        return joined(time, good) if good else None

    def target(self, size: tuple[int, int]) -> Setting:
        """Describe the cube."""
        return target_of(self.cube, size)


class BoardFinder:
    """Finds the inner corners of a ChArUco board."""

    names: tuple[str, ...] = ("board",)

    def __init__(self, board: Board) -> None:
        self.board = board
        self._detector = cv2.aruco.CharucoDetector(board.pattern)

    def find(self, grey: Grey, timestamp: float) -> Found | None:
        """Find corners; too few of them, or all on one line, are none."""
        corners, ids = self._detector.detectBoard(grey)[:2]
        # OpenCV gives None where there is no board.
        pixels = np.reshape([] if corners is None else corners, (-1, 2)).astype(np.float64)
        points = self.board.points[np.ravel([] if ids is None else ids).astype(np.intp)]
        if len(pixels) < self.board.fewest:
            return None
        if np.linalg.matrix_rank(points[:, :2] - points[0, :2], tol=1e-6) < 2:
            return None
        homography = np.asarray(cv2.findHomography(points[:, :2], pixels)[0], np.float64)
        outline = cv2.perspectiveTransform(self.board.outline[:, None, :2], homography)
        view = of_corners(timestamp, np.zeros(len(pixels), np.intp), points, pixels)
        return Found(view, (np.asarray(outline, np.float64).reshape(4, 2),), (0,))

    def measure(self, grey: Grey, found: Found) -> View | None:
        """Give what was found: two edges cross in each corner, so blur and gamma cancel there."""
        return found.corners

    def target(self, size: tuple[int, int]) -> Setting:
        """Describe the board: one plate that is what it is."""
        centre = self.board.points.mean(axis=0)[None]
        return Setting(size, np.ones(9, np.bool_), centre, crooked=False)
