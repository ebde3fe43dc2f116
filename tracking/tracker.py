"""From camera frames to where the cube is: detection, corner pose, edge refinement, and trust."""

from dataclasses import dataclass
from typing import Literal

import cv2
import numpy as np
from numpy.typing import NDArray

from tracking import prediction, se3
from tracking.cube import CubeModel
from tracking.detection import MarkerDetector, Observation, Region
from tracking.errors import TrackingError
from tracking.frame import Frame
from tracking.intrinsics import Intrinsics
from tracking.prediction import MEMORY, Sighting
from tracking.projection import Projection
from tracking.refinement import EdgeRefiner, Refinement
from tracking.solver import CornerSolution, looks_at_camera, solve
from tracking.state import CubeState

Array = NDArray[np.float64]

FLOOR = (2e-5, 2e-5, 4e-5, 1e-4, 1e-4, 1e-4)
"""Smallest standard deviations of a shift-turn that are claimed [m, rad]: no model is better."""

STRAY = 1.0
"""Edges and corners must agree to this share of a cell, or the edges found something else."""


@dataclass(frozen=True)
class _Candidate:
    """A pose found in one frame, before it is trusted."""

    camera_from_cube: Array
    covariance: Array
    source: Literal["markers", "image"]
    faces: tuple[str, ...]
    error: float
    quality: float
    """Edge residual [px], or corner error where the edges did not help; smaller is better."""


class CubeTracker:
    """Follows one cube through the frames of one camera.

    Parameters
    ----------
    cube
        The cube, as printed.
    intrinsics
        The camera; every frame must have its size.

    Notes ----- There is no smoothing filter: a pose rests on its own frame alone, so it has no lag.
    The past is used to look in the right place, to choose between the two poses of a single face,
    and to distrust jumps.
    """

    def __init__(self, cube: CubeModel, intrinsics: Intrinsics) -> None:
        self.cube = cube
        self.intrinsics = intrinsics
        self._projection = Projection(intrinsics)
        self._detector = MarkerDetector(cube)
        self._refiner = EdgeRefiner(cube, self._projection)
        self._last: Sighting | None = None
        self._jump: Sighting | None = None

    def update(self, frame: Frame) -> CubeState:
        """Find the cube in the next frame.

        Raises
        ------
        TrackingError
            The frame has not the size that the intrinsics hold for.
        """
        grey = self._grey(frame)
        expected = self._expected(frame.timestamp)
        candidates = self._candidates(grey, expected)
        if not candidates:
            return self._unseen(frame.timestamp, "")
        candidate, refused = self._chosen(candidates, expected)
        if not refused and not self._confirmed(candidate, frame.timestamp):
            refused = "jump"
        if refused:
            return self._unseen(frame.timestamp, refused)
        return self._seen(candidate, frame.timestamp)

    def _grey(self, frame: Frame) -> NDArray[np.uint8]:
        height, width = frame.image.shape[:2]
        if (width, height) != tuple(self.intrinsics.size):
            wanted = "×".join(str(n) for n in self.intrinsics.size)
            raise TrackingError(
                f"frame {frame.index} is {width}×{height} but the intrinsics hold for {wanted}; "
                "scale them or calibrate at this size"
            )
        return np.asarray(cv2.cvtColor(frame.image, cv2.COLOR_BGR2GRAY))

    def _expected(self, timestamp: float) -> Array | None:
        if self._last is None or not 0 <= timestamp - self._last.timestamp <= MEMORY:
            return None
        return prediction.predicted(self._last, timestamp)

    def _candidates(self, grey: NDArray[np.uint8], expected: Array | None) -> list[_Candidate]:
        solutions: list[CornerSolution] = []
        region = self._region(expected) if expected is not None else None
        if region is not None:
            solutions = solve(self._detector.detect(grey, region), self._projection, expected)
        if not solutions:
            solutions = solve(self._detector.detect(grey), self._projection, expected)
        return [self._refined(grey, solution) for solution in solutions]

    def _refined(self, grey: NDArray[np.uint8], solution: CornerSolution) -> _Candidate:
        faces = tuple(seen.face.name for seen in solution.observations)
        refinement = self._refiner.refine(grey, solution.camera_from_cube)
        if refinement is None or not self._agree(solution, refinement):
            return _Candidate(
                solution.camera_from_cube,
                solution.covariance + np.diag(np.square(FLOOR)) * 25,
                "markers",
                faces,
                solution.error,
                max(solution.error, 0.5),
            )
        error = self._corner_error(refinement.camera_from_cube, solution.observations)
        return _Candidate(
            refinement.camera_from_cube,
            refinement.covariance + np.diag(np.square(FLOOR)),
            "markers",
            faces,
            error,
            refinement.residual / refinement.support,
        )

    def _agree(self, solution: CornerSolution, refinement: Refinement) -> bool:
        """Whether the edges moved the pose by less than the corners allow."""
        pose = refinement.camera_from_cube
        if not all(looks_at_camera(seen.face, pose) for seen in solution.observations):
            return False
        cells = min(seen.size for seen in solution.observations) / 6
        error = self._corner_error(pose, solution.observations)
        return refinement.support > 0.3 and error < solution.error + STRAY * cells

    def _corner_error(self, pose: Array, observations: tuple[Observation, ...]) -> float:
        points = np.concatenate([seen.face.corners for seen in observations])
        corners = np.concatenate([seen.corners for seen in observations])
        pixels = self._projection.pixels(points @ pose[:3, :3].T + pose[:3, 3])
        return float(np.sqrt(((pixels - corners) ** 2).sum(axis=1).mean()))

    def _region(self, expected: Array) -> Region | None:
        """Surround the predicted cube, with room for a hand's acceleration."""
        half = self.cube.edge / 2
        signs = np.array([(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)], np.float64)
        points = signs * half @ expected[:3, :3].T + expected[:3, 3]
        if points[:, 2].min() < 0.03:
            return None
        pixels = self._projection.pixels(points)
        low, high = pixels.min(axis=0), pixels.max(axis=0)
        margin = 0.35 * float((high - low).max()) + 16
        width, height = self.intrinsics.size
        left, top = (int(v) for v in np.clip(low - margin, 0, (width, height)))
        right, bottom = (int(v) for v in np.clip(high + margin + 1, 0, (width, height)))
        if right - left < 32 or bottom - top < 32:
            return None
        return left, top, right, bottom

    def _chosen(
        self, candidates: list[_Candidate], expected: Array | None
    ) -> tuple[_Candidate, str]:
        """Choose between the poses that explain the same markers, or refuse to."""
        candidates = sorted(candidates, key=lambda candidate: candidate.quality)
        best = candidates[0]
        if len(candidates) == 1:
            return best, ""
        other = candidates[1]
        if _close(best.camera_from_cube, other.camera_from_cube):
            return best, ""
        if best.quality < 0.6 * other.quality:
            return best, ""
        if expected is not None:
            away = [se3.angle_between(expected, each.camera_from_cube) for each in (best, other)]
            if min(away) < np.deg2rad(15) and max(away) > 2 * min(away):
                return (best, other)[int(np.argmin(away))], ""
        return best, "ambiguous"

    def _confirmed(self, candidate: _Candidate, timestamp: float) -> bool:
        """Whether a hand can have brought the cube there, or a second frame says so too."""
        pose = candidate.camera_from_cube
        if self._last is None or timestamp - self._last.timestamp > 1.0:
            return True
        if prediction.plausible(self._last, pose, timestamp):
            return True
        before = self._jump
        self._jump = Sighting(pose, np.zeros(6), candidate.covariance, timestamp)
        return (
            before is not None
            and timestamp - before.timestamp <= MEMORY
            and prediction.plausible(before, pose, timestamp)
        )

    def _seen(self, candidate: _Candidate, timestamp: float) -> CubeState:
        pose = candidate.camera_from_cube
        before = self._last
        if before is not None and not prediction.plausible(before, pose, timestamp):
            before = self._jump if self._jump and self._jump.timestamp < timestamp else None
        velocity = prediction.velocity(before, pose, timestamp)
        self._last = Sighting(pose, velocity, candidate.covariance, timestamp)
        self._jump = None
        return CubeState(
            True,
            pose,
            velocity,
            candidate.covariance,
            candidate.source,
            candidate.faces,
            candidate.error,
            timestamp,
        )

    def _unseen(self, timestamp: float, refused: str) -> CubeState:
        last, expected = self._last, self._expected(timestamp)
        if last is None or expected is None:
            nowhere = np.full((6, 6), np.nan)
            return CubeState(
                False, None, np.zeros(6), nowhere, "predicted", (), np.nan, timestamp, refused
            )
        covariance = prediction.predicted_covariance(last, timestamp)
        return CubeState(
            False,
            expected,
            last.velocity,
            covariance,
            "predicted",
            (),
            np.nan,
            timestamp,
            refused,
        )


def _close(a: Array, b: Array) -> bool:
    step = se3.motion(a, b)
    return bool(np.linalg.norm(step[:3]) < 0.004 and np.linalg.norm(step[3:]) < np.deg2rad(4))
