"""Choosing views from a camera's frames: still ones that show something new."""

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Literal

import cv2
import numpy as np

from cubeling.tracking.calibration import camera_vector, initialization
from cubeling.tracking.calibration.coverage import ViewCoverage, ViewSample
from cubeling.tracking.calibration.solver import Calibration, calibrate, measured_cube
from cubeling.tracking.calibration.target_finders import CubeFinder, TargetDetection, TargetFinder
from cubeling.tracking.calibration.view import View
from cubeling.tracking.cube.model import CubeModel
from cubeling.tracking.errors import TrackingError
from cubeling.tracking.geometry import se3
from cubeling.tracking.geometry.arrays import Array
from cubeling.tracking.geometry.frame import Frame
from cubeling.tracking.geometry.intrinsics import Intrinsics

MAX_SPEED = 0.09
"""A target that moves faster than this is too blurred to measure [image widths/s]."""

MIN_SHIFT, MIN_ROTATION_RAD, MIN_DISTANCE_RATIO_LOG = 0.10, np.deg2rad(12), 0.18
"""A view is new if it differs from every other one by one of these: position [image widths],
orientation [rad], or natural logarithm of the ratio of their distances."""

MAX_VIEWS = 90
"""More views than this add no accuracy."""

ViewVerdict = Literal["unseen", "moving", "known", "unclear", "taken", "full"]


@dataclass(frozen=True)
class ViewResult:
    """The result of one frame."""

    verdict: ViewVerdict
    """Whether the frame became a view, or why not."""

    outlines: tuple[Array, ...]
    """Outlines of the detected plates, each (4, 2) [px]."""

    sample: ViewSample | None
    """How the target appears; None if it was not detected."""


class ViewCollector:
    """Chooses views from the frames of one camera and keeps account of their coverage.

    Parameters
    ----------
    finder
        Finds and measures the target.
    size
        Width and height of the frames [px].
    """

    def __init__(self, finder: TargetFinder, size: tuple[int, int]) -> None:
        self._finder = finder
        self.size = size
        """Width and height of the frames [px]."""
        # A guessed camera is good enough to compare poses.
        self._camera = camera_vector.from_intrinsics(Intrinsics.guess(size))
        self._previous: TargetDetection | None = None
        self._poses: list[tuple[Array, frozenset[int]]] = []
        self.coverage = ViewCoverage(finder.names)
        """Which kinds of views there are and which are missing."""
        self.views: list[View] = []
        """The views so far."""
        self.outlines: list[Array] = []
        """Outlines of the plates in all views, each (4, 2) [px]."""

    def update(self, frame: Frame) -> ViewResult:
        """Process the next frame."""
        grey = np.asarray(cv2.cvtColor(frame.image, cv2.COLOR_BGR2GRAY), np.uint8)
        found = self._finder.find(grey, frame.timestamp)
        previous, self._previous = self._previous, found
        pose = None if found is None else initialization.best_pose(found.corners, self._camera)
        if found is None or pose is None:
            return ViewResult("unseen", (), None)
        sample = self._sample(found, pose)
        plates = frozenset(found.plates)
        if len(self.views) >= MAX_VIEWS:
            verdict: ViewVerdict = "full"
        elif not self._is_new(pose, plates):
            verdict = "known"
        elif _speed(found, previous) > MAX_SPEED * self.size[0]:
            verdict = "moving"
        elif (view := self._finder.measure(grey, found)) is None:
            verdict = "unclear"
        else:
            verdict = "taken"
            self.views.append(view)
            self.outlines += found.outlines
            self._poses.append((pose, plates))
            self.coverage.add(sample)
        return ViewResult(verdict, found.outlines, sample)

    def _is_new(self, pose: Array, plates: frozenset[int]) -> bool:
        """Return whether no view shows the same plates in nearly the same pose."""
        distance = max(float(pose[2, 3]), 1e-3)
        for other, other_plates in self._poses:
            step = se3.delta(other, pose)
            shift = float(np.linalg.norm(step[:2])) * self._camera[0] / distance / self.size[0]
            ratio_log = abs(float(np.log(distance / max(float(other[2, 3]), 1e-3))))
            rotation = float(np.linalg.norm(step[3:]))
            same = shift < MIN_SHIFT and rotation < MIN_ROTATION_RAD
            if same and ratio_log < MIN_DISTANCE_RATIO_LOG and plates == other_plates:
                return False
        return True

    def _sample(self, found: TargetDetection, pose: Array) -> ViewSample:
        sides = [
            np.linalg.norm(outline - np.roll(outline, 1, axis=0), axis=1).mean()
            for outline in found.outlines
        ]
        x, y = np.concatenate(found.outlines).mean(axis=0) / self.size
        size = float(max(sides)) / self.size[1]
        return ViewSample((float(x), float(y)), size, _tilt(found, pose), found.plates)


def _speed(found: TargetDetection, previous: TargetDetection | None) -> float:
    """Return the speed of the plates in the image [px/s]; infinite if it is unknown."""
    if previous is None:
        return np.inf
    before = dict(zip(previous.plates, previous.outlines, strict=True))
    shifts = [
        np.linalg.norm(outline - before[plate], axis=1).max()
        for plate, outline in zip(found.plates, found.outlines, strict=True)
        if plate in before
    ]
    elapsed = found.corners.timestamp - previous.corners.timestamp
    return float(max(shifts)) / elapsed if shifts and elapsed > 0 else np.inf


def _tilt(found: TargetDetection, pose: Array) -> tuple[float, float]:
    """Return the tilt of the plate that faces the camera most directly: see `ViewSample.tilt`."""
    best, smallest_angle = np.zeros(2), np.inf
    view = found.corners
    for plate in found.plates:
        points = np.unique(view.points[view.plates == plate], axis=0)
        in_camera = points @ pose[:3, :3].T + pose[:3, 3]
        centre = in_camera.mean(axis=0)
        sight = centre / np.linalg.norm(centre)
        normal = np.linalg.svd(in_camera - centre)[2][2]
        normal = normal if normal @ sight < 0 else -normal
        difference = normal + sight
        angle = float(np.arccos(np.clip(-normal @ sight, -1, 1)))
        if angle < smallest_angle:
            smallest_angle = angle
            best = difference[:2] * angle / max(float(np.linalg.norm(difference[:2])), 1e-9)
    return float(best[0]), float(best[1])


def calibrate_camera(frames: Iterable[Frame], cube: CubeModel) -> tuple[Calibration, CubeModel]:
    """Calibrate a camera from frames in which the printed cube is waved.

    Parameters
    ----------
    frames
        Frames of one size, in order, as `open_source` returns them.
    cube
        The cube as it was printed.

    Returns
    -------
    The calibration, and the cube as it was actually folded.

    Raises
    ------
    TrackingError
        There are too few still views of the cube, or they do not determine the camera.
    """
    finder = CubeFinder(cube)
    collector: ViewCollector | None = None
    for frame in frames:
        if collector is None:
            collector = ViewCollector(finder, (frame.image.shape[1], frame.image.shape[0]))
        collector.update(frame)
    if collector is None:
        raise TrackingError("there is no frame to calibrate the camera with")
    found = calibrate(collector.views, finder.target(collector.size))
    found.check()
    return found, measured_cube(cube, found.plates)
