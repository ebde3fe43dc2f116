"""The pose that the corners of all detected markers agree on."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import cv2
import numpy as np

from cubeling.tracking.cube.model import CubeModel, Face
from cubeling.tracking.detection.markers import Observation
from cubeling.tracking.geometry import se3
from cubeling.tracking.geometry.arrays import Array
from cubeling.tracking.geometry.projection import MIN_DEPTH, Projection, planar_poses
from cubeling.tracking.geometry.robust_statistics import quantile

MIN_FACING_COSINE = 0.05
"""Cosine between a face's normal and the line of sight below which its marker cannot be read."""

MAX_PROPOSED_ERROR, MAX_REFINED_ERROR = 0.15, 0.06
"""A marker agrees with a proposed pose, and with a refined one, within this share of its side."""

MAX_LAST_STEP = 2e-5
"""A step smaller than this is the last one [m, rad]: corners are not that exact."""

MIN_TOLERANCE_PX = 2.0
"""Corners closer than this agree in any case."""


@dataclass(frozen=True)
class CornerPose:
    """A pose with the markers that agree with it."""

    camera_from_cube: Array
    """Pose of the cube, (4, 4) [m]."""

    observations: tuple[Observation, ...]
    """The markers that agree with it, at most one for each face."""

    error: float
    """Root mean square reprojection error of their corners [px]."""

    covariance: Array
    """Of a pose delta, (6, 6)."""


@dataclass(frozen=True)
class _FaceGeometry:
    centre: Array
    normal: Array
    marker_from_cube: Array
    side: float

    @classmethod
    def of(cls, face: Face) -> "_FaceGeometry":
        """Frame of the marker: x to its right, y to its top, z outward."""
        top_left, top_right, _, bottom_left = face.corners
        side = float(np.linalg.norm(top_right - top_left))
        axes = [(top_right - top_left) / side, (top_left - bottom_left) / side, face.normal]
        centre = face.corners.mean(axis=0)
        frame = se3.pose(np.stack(axes, axis=1), centre)
        return cls(centre, face.normal, se3.inverse(frame), side)


class _Detections:
    """Detected markers as arrays, so that all of them are compared with a pose at once."""

    def __init__(self, observations: Sequence[Observation]) -> None:
        self.observations = observations
        self.faces = [seen.face.name for seen in observations]
        self.points = np.stack([seen.face.corners for seen in observations])
        """Their corners on the cube, (N, 4, 3) [m]."""
        self.corners = np.stack([seen.corners for seen in observations])
        """Their corners in the image, (N, 4, 2) [px]."""
        self.normals = np.stack([seen.face.normal for seen in observations])
        """Normals of their faces, (N, 3)."""
        self.sizes = np.array([seen.size for seen in observations])
        """Mean lengths of their sides in the image, (N,) [px]."""


class CornerPoseSolver:
    """Solves for poses of one rigid cube seen by one camera."""

    def __init__(self, cube: CubeModel, projection: Projection) -> None:
        self._projection = projection
        self._geometry = {face.name: _FaceGeometry.of(face) for face in cube.faces}

    def solve(
        self, observations: Sequence[Observation], expected: Array | None = None
    ) -> list[CornerPose]:
        """Find the poses that explain the detected markers, at most two, the best first.

        Every marker alone proposes its two poses. The proposal that most other markers agree with
        is refined on all of them together. Markers that disagree are left out: a second cube, a
        picture of a marker, a misread id. The same face may occur twice.

        `expected` is the predicted pose, (4, 4): a first proposal, and the choice between two cubes
        with equally many markers. A second pose has as many markers as the best: the other pose of
        a single face seen from afar, or another cube.
        """
        if not observations:
            return []
        detected = _Detections(observations)
        if expected is not None and len(observations) > 1:
            solution = self._consensus(expected, detected)
            if solution and len(solution.observations) == len(observations):
                return [solution]
        solutions: list[CornerPose] = []
        for start in self._proposals(observations):
            solution = self._consensus(start, detected)
            if solution and 1 < len(observations) == len(solution.observations):
                return [solution]
            if solution and not any(_same(solution, other) for other in solutions):
                solutions.append(solution)
        solutions.sort(key=lambda solution: _rank(solution, expected))
        most = len(solutions[0].observations) if solutions else 0
        return [solution for solution in solutions if len(solution.observations) == most][:2]

    def looks_at_camera(self, face: str, camera_from_cube: Array) -> bool:
        """Whether a face shows its outside, and not at a grazing angle."""
        rotation, geometry = camera_from_cube[:3, :3], self._geometry[face]
        centre = rotation @ geometry.centre + camera_from_cube[:3, 3]
        cosine = -(rotation @ geometry.normal) @ centre
        return bool(centre[2] > MIN_DEPTH and cosine > MIN_FACING_COSINE * np.sqrt(centre @ centre))

    def error(self, camera_from_cube: Array, observations: Sequence[Observation]) -> float:
        """Root mean square reprojection error of the corners at a pose [px]."""
        points = np.concatenate([seen.face.corners for seen in observations])
        corners = np.concatenate([seen.corners for seen in observations])
        in_camera = points @ camera_from_cube[:3, :3].T + camera_from_cube[:3, 3]
        if in_camera[:, 2].min() < MIN_DEPTH:
            return np.inf
        away = self._projection.project(in_camera) - corners
        return float(np.sqrt((away**2).sum(axis=1).mean()))

    def _proposals(self, observations: Sequence[Observation]) -> Iterator[Array]:
        """Poses of the cube from each marker alone, two of each."""
        for seen in observations:
            geometry = self._geometry[seen.face.name]
            square = np.array([(-1, 1, 0), (1, 1, 0), (1, -1, 0), (-1, -1, 0)]) * geometry.side / 2
            rays = self._projection.rays(seen.corners)
            for marker in planar_poses(square, rays, cv2.SOLVEPNP_IPPE_SQUARE):
                yield marker @ geometry.marker_from_cube

    def _consensus(self, start: Array, detected: _Detections) -> CornerPose | None:
        """Refine a proposal on all markers that agree with it, until these stay the same."""
        agreeing = self._inliers(start, detected, MAX_PROPOSED_ERROR)
        for _ in range(3):
            if not agreeing:
                return None
            solution = self._refine(start, agreeing)
            start = solution.camera_from_cube
            before, agreeing = agreeing, self._inliers(start, detected, MAX_REFINED_ERROR)
            if [id(seen) for seen in agreeing] == [id(seen) for seen in before]:
                return solution
        return None

    def _inliers(self, pose: Array, detected: _Detections, tolerance: float) -> list[Observation]:
        """Return the best marker of each face whose error is within a share of its side."""
        rotation, shift = pose[:3, :3], pose[:3, 3]
        in_camera = detected.points @ rotation.T + shift
        centres = in_camera.mean(axis=1)
        cosines = -((detected.normals @ rotation.T) * centres).sum(axis=1)
        good = cosines > MIN_FACING_COSINE * np.linalg.norm(centres, axis=1)
        good &= in_camera[..., 2].min(axis=1) > MIN_DEPTH
        in_camera[~good] = (0.0, 0.0, 1.0)  # can be projected
        pixels = self._projection.project(in_camera.reshape(-1, 3)).reshape(-1, 4, 2)
        errors = np.sqrt(((pixels - detected.corners) ** 2).sum(axis=2).mean(axis=1))
        good &= errors < np.maximum(MIN_TOLERANCE_PX, tolerance * detected.sizes)
        best: dict[str, int] = {}
        for index in np.flatnonzero(good).tolist():
            name = detected.faces[index]
            if name not in best or errors[index] < errors[best[name]]:
                best[name] = index
        return [detected.observations[index] for index in best.values()]

    def _refine(self, start: Array, observations: Sequence[Observation]) -> CornerPose:
        """Minimise the reprojection error by Gauss-Newton with Huber weights."""
        points = np.concatenate([seen.face.corners for seen in observations])
        corners = np.concatenate([seen.corners for seen in observations])
        current = start
        for _ in range(6):
            residuals, rows = self._linearise(current, points, corners)
            lengths = np.sqrt((residuals**2).sum(axis=1))
            weights = 1 / np.maximum(1, lengths / max(0.5, 2 * quantile(lengths, 0.5)))
            weighted = (rows * weights[:, None, None]).reshape(-1, 6)
            flat = rows.reshape(-1, 6)
            step = np.linalg.solve(weighted.T @ flat, weighted.T @ residuals.ravel())
            current = se3.apply_delta(current, step)
            if np.abs(step).max() < MAX_LAST_STEP:
                break
        residuals, rows = self._linearise(current, points, corners)
        squares = float((residuals**2).sum())
        # One face leaves two degrees of freedom, too few to judge by: assume at least 0.3 px.
        spread = max(0.3**2, squares / max(1, residuals.size - 6))
        flat = rows.reshape(-1, 6)
        covariance = np.asarray(np.linalg.inv(flat.T @ flat), np.float64) * spread
        error = float(np.sqrt(squares / len(residuals)))
        return CornerPose(current, tuple(observations), error, covariance)

    def _linearise(self, pose: Array, points: Array, corners: Array) -> tuple[Array, Array]:
        """Residuals, (N, 2) [px], and their Jacobian by a pose delta, (N, 2, 6)."""
        rotated = points @ pose[:3, :3].T
        pixels, jacobian = self._projection.project_with_jacobian(rotated + pose[:3, 3])
        return corners - pixels, np.concatenate([jacobian, -jacobian @ se3.hat(rotated)], axis=2)


def _rank(solution: CornerPose, expected: Array | None) -> tuple[float, ...]:
    """Sort by number of markers, then by distance from the expected pose, then by error."""
    far = 0.0
    if expected is not None:
        away = solution.camera_from_cube[:3, 3] - expected[:3, 3]
        far = float(np.linalg.norm(away) > 0.1)
    return -len(solution.observations), far, solution.error


def _same(a: CornerPose, b: CornerPose) -> bool:
    step = se3.delta(a.camera_from_cube, b.camera_from_cube)
    return bool(np.linalg.norm(step[:3]) < 0.005 and np.linalg.norm(step[3:]) < np.deg2rad(4))
