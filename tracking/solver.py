"""The pose that the corners of all seen markers agree on."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from tracking import se3
from tracking.cube import Face
from tracking.detection import Observation
from tracking.projection import Projection

Array = NDArray[np.float64]

NEAREST = 0.03
"""A cube closer to the camera than this [m] cannot be seen whole; a pose that says so is wrong."""

GRAZING = 0.05
"""Cosine between a face's normal and the line of sight below which its marker cannot be read."""


@dataclass(frozen=True)
class CornerSolution:
    """A pose with the markers that support it."""

    camera_from_cube: Array
    """Pose of the cube, (4, 4) [m]."""

    observations: tuple[Observation, ...]
    """The markers that agree with it, at most one for each face."""

    error: float
    """Root mean square distance of their corners from where the pose puts them [px]."""

    covariance: Array
    """Of a shift-turn, (6, 6)."""


def solve(
    observations: Sequence[Observation], projection: Projection, expected: Array | None = None
) -> list[CornerSolution]:
    """Find the poses of one rigid cube that explain the seen markers, the best first.

    Every marker alone proposes its two poses; the proposal that most other markers agree with is
    refined on all of them together. Markers that disagree with it are left out: a second cube, a
    picture of a marker, a misread id.

    Parameters
    ----------
    observations
        What the detector saw; the same face may be there twice.
    projection
        The camera.
    expected
        Where the cube should be by its past, (4, 4): breaks ties between two cubes, no more.

    Returns ------- The best pose and, where another with the same support exists, (the second pose
    of a single face seen from afar, a second cube), that one too. Empty where no pose with its
    faces towards the camera exists.
    """
    solutions: list[CornerSolution] = []
    for start in _proposals(observations, projection):
        solution = _grow(start, observations, projection)
        if solution and not any(_same(solution, other) for other in solutions):
            solutions.append(solution)
    if not solutions:
        return []

    def rank(solution: CornerSolution) -> tuple[float, ...]:
        far = 0.0
        if expected is not None:
            step = se3.motion(expected, solution.camera_from_cube)
            far = float(np.linalg.norm(step[:3]) > 0.1)
        return -len(solution.observations), far, solution.error

    solutions.sort(key=rank)
    support = len(solutions[0].observations)
    return [solution for solution in solutions if len(solution.observations) == support][:2]


def looks_at_camera(face: Face, camera_from_cube: Array, cosine: float = GRAZING) -> bool:
    """Whether the outside of a face is seen, and not at a grazing angle."""
    centre = camera_from_cube[:3, :3] @ face.corners.mean(axis=0) + camera_from_cube[:3, 3]
    normal = camera_from_cube[:3, :3] @ face.normal
    return bool(centre[2] > NEAREST and -normal @ centre > cosine * np.linalg.norm(centre))


def refine_on_corners(
    start: Array, observations: Sequence[Observation], projection: Projection
) -> CornerSolution:
    """Minimise the reprojection error over a shift-turn by Gauss-Newton with Huber weights."""
    points = np.concatenate([seen.face.corners for seen in observations])
    corners = np.concatenate([seen.corners for seen in observations])
    current = start
    for _ in range(8):
        residuals, jacobian = _linearised(current, points, corners, projection)
        lengths = np.linalg.norm(residuals, axis=1)
        weights = 1 / np.maximum(1, lengths / max(0.5, float(np.median(lengths)) * 2))
        weighted = jacobian * weights[:, None, None]
        normal = np.einsum("nik,nil->kl", weighted, jacobian)
        step = np.linalg.solve(
            normal + np.diag(np.diag(normal)) * 1e-9, np.einsum("nik,ni->k", weighted, residuals)
        )
        current = se3.moved(current, step)
        if np.abs(step).max() < 1e-7:
            break
    residuals, jacobian = _linearised(current, points, corners, projection)
    error = float(np.sqrt((residuals**2).sum(axis=1).mean()))
    normal = np.einsum("nik,nil->kl", jacobian, jacobian)
    # One face of four corners leaves two degrees of freedom, too few to judge by: assume 0.3 px at
    # least.
    spread = max(0.3**2, float((residuals**2).sum()) / max(1, residuals.size - 6))
    return CornerSolution(current, tuple(observations), error, np.linalg.pinv(normal) * spread)


def _proposals(observations: Sequence[Observation], projection: Projection) -> Iterator[Array]:
    """Poses of the cube from each marker alone: both of IPPE (Collins and Bartoli, 2014)."""
    for seen in observations:
        cube_from_marker, side = _marker_frame(seen.face)
        square = np.array([(-1, 1, 0), (1, 1, 0), (1, -1, 0), (-1, -1, 0)]) * (side / 2)
        found, turns, origins = cv2.solvePnPGeneric(
            square,
            projection.rays(seen.corners).reshape(-1, 1, 2),
            np.eye(3),
            None,
            flags=cv2.SOLVEPNP_IPPE_SQUARE,
        )[:3]
        for turn, origin in zip(turns, origins, strict=True) if found else ():
            vectors = np.array([turn, origin], np.float64).reshape(2, 3)
            marker = se3.pose(se3.rotation(vectors[0]), vectors[1])
            if np.isfinite(marker).all():
                yield marker @ se3.inverse(cube_from_marker)


def _marker_frame(face: Face) -> tuple[Array, float]:
    """Return the frame of a marker, x to its right, y to its top, z outward, and its side [m]."""
    top_left, top_right, _, bottom_left = face.corners
    side = float(np.linalg.norm(top_right - top_left))
    turn = np.stack(
        [(top_right - top_left) / side, (top_left - bottom_left) / side, face.normal], axis=1
    )
    return se3.pose(turn, face.corners.mean(axis=0)), side


def _grow(
    start: Array, observations: Sequence[Observation], projection: Projection
) -> CornerSolution | None:
    """Refine a proposal on all markers that agree with it: first loosely, then strictly."""
    current = start
    solution = None
    for tolerance in (0.15, 0.06, 0.06):
        agreeing = _agreeing(current, observations, projection, tolerance)
        if not agreeing:
            return None
        solution = refine_on_corners(current, agreeing, projection)
        current = solution.camera_from_cube
    if solution is None or len(_agreeing(current, solution.observations, projection, 0.06)) < len(
        solution.observations
    ):
        return None
    return solution


def _agreeing(
    camera_from_cube: Array,
    observations: Sequence[Observation],
    projection: Projection,
    tolerance: float,
) -> list[Observation]:
    """Return the best observation of each face that lies within `tolerance` of its own size."""
    best: dict[str, tuple[float, Observation]] = {}
    for seen in observations:
        if not looks_at_camera(seen.face, camera_from_cube):
            continue
        points = seen.face.corners @ camera_from_cube[:3, :3].T + camera_from_cube[:3, 3]
        if points[:, 2].min() < NEAREST:
            continue
        away = np.linalg.norm(projection.pixels(points) - seen.corners, axis=1)
        error = float(np.sqrt((away**2).mean()))
        known = best.get(seen.face.name)
        if error < max(2.0, tolerance * seen.size) and (known is None or error < known[0]):
            best[seen.face.name] = (error, seen)
    return [seen for _, seen in best.values()]


def _linearised(
    camera_from_cube: Array, points: Array, corners: Array, projection: Projection
) -> tuple[Array, Array]:
    """Residuals, (N, 2) [px], and their slopes by a shift-turn, (N, 2, 6)."""
    turned = points @ camera_from_cube[:3, :3].T
    pixels, slopes = projection.pixels_and_slopes(turned + camera_from_cube[:3, 3])
    return corners - pixels, np.concatenate([slopes, -slopes @ se3.hat(turned)], axis=2)


def _same(a: CornerSolution, b: CornerSolution) -> bool:
    step = se3.motion(a.camera_from_cube, b.camera_from_cube)
    return bool(np.linalg.norm(step[:3]) < 0.005 and np.linalg.norm(step[3:]) < np.deg2rad(4))
