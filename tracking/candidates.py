"""Poses that one frame proposes: from markers refined on edges, or from edges alone."""

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from tracking import prediction, se3
from tracking.cube import CubeModel
from tracking.detection import MarkerDetector, Region
from tracking.prediction import Sighting
from tracking.projection import Projection
from tracking.refinement import EdgeRefiner, Refinement
from tracking.solver import NEAREST, CornerSolution, CornerSolver

Array = NDArray[np.float64]
Picture = NDArray[np.uint8]

FLOOR = np.array([5e-6, 5e-6, 1.2e-5, 6e-5, 6e-5, 4e-5])
"""Smallest standard deviations of a shift-turn that are claimed [m, rad]: no model is better."""

BLUR_FLOOR = np.array([2e-3, 2e-3, 3e-3, 0.02, 0.02, 0.02])
"""The same for a pose from blurred edges: they lie where the cube was in mid-exposure, at best."""

STRAY = 1.0
"""Edges and corners must agree to this share of a cell, or the edges found something else."""

LONE_CORNERS = 1.15
"""Where only one marker was read, its corners must be as near as this to the edges [px]: blur pulls
the two apart, and would put the cube centimetres too near or too far."""

CLEAR = 0.15
"""An edge residual below this [px] is that of a sharp picture of the right pose."""

SEEN = 0.3
"""Share of the edges in view that must be found beside the markers; fingers cover the rest."""

SEEN_ALONE = 0.6
"""The same where no marker was read, so that the edges alone prove that this is the cube."""

WHOLE_FACE = 0.85
"""The same for the edges of the only face whose marker was read: blur that hides the other faces
leaves less of it, fingers that do so leave all of it."""

FINE_CELL = 4.0
"""Cells larger than this [px] have edges that a sharp picture shows."""


@dataclass(frozen=True)
class Candidate:
    """A pose found in one frame, before it is trusted."""

    camera_from_cube: Array
    """Pose of the cube, (4, 4) [m]."""

    covariance: Array
    """Of a shift-turn, (6, 6)."""

    source: Literal["markers", "image"]
    """As in `CubeState.source`."""

    faces: tuple[str, ...]
    """As in `CubeState.faces`."""

    error: float
    """As in `CubeState.reprojection_error` [px]."""

    residual: float
    """Edge residual over the share of edges found, or the corner error [px]; smaller is better."""

    certain: bool
    """Whether edges confirm it beyond doubt, or two markers and edges do."""

    blurred: bool = False
    """Whether one marker alone vouches for it, whose edges should have been seen but were not."""


class CandidateFinder:
    """Proposes poses of one cube seen by one camera."""

    def __init__(self, cube: CubeModel, projection: Projection) -> None:
        self._projection = projection
        self._detector = MarkerDetector(cube)
        self._solver = CornerSolver(cube, projection)
        self._refiner = EdgeRefiner(cube, projection)
        signs = [(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]
        self._hull = np.array(signs, np.float64) * cube.edge / 2

    def find(self, grey: Picture, last: Sighting | None, timestamp: float) -> list[Candidate]:
        """Propose up to two poses for a picture.

        Parameters
        ----------
        grey
            The picture, (H, W).
        last
            The last sighting, if it is recent enough to tell where to look: then only the region
            round the predicted cube is searched for markers, and the whole picture where that
            fails.
        timestamp
            That of the picture [s].
        """
        expected = prediction.predicted(last, timestamp) if last else None
        region = self._region(expected) if expected is not None else None
        found: list[Candidate] = []
        if region is not None:
            found = self._from_markers(grey, region, expected)
        if last is not None and not any(candidate.certain for candidate in found):
            alone = self._from_past(grey, last, timestamp)
            found = (
                [alone] if alone else [each for each in found if self._fits(each, last, timestamp)]
            )
        return found or self._from_markers(grey, None, expected)

    def _fits(self, candidate: Candidate, last: Sighting, timestamp: float) -> bool:
        """Whether a pose that rests on a single marker is where the cube should be."""
        return len(candidate.faces) > 1 or prediction.near(
            last, candidate.camera_from_cube, timestamp
        )

    def _from_markers(
        self, grey: Picture, region: Region | None, expected: Array | None
    ) -> list[Candidate]:
        observations = self._detector.detect(grey, region)
        solutions = self._solver.solve(observations, expected)
        if expected is not None:
            solutions.sort(key=lambda each: se3.angle_between(each.camera_from_cube, expected))
        found: list[Candidate] = []
        for solution in solutions:
            start = solution.camera_from_cube
            found.append(self._judged(solution, self._refiner.refine(grey, start)))
            if expected is not None and found[0].certain and found[0].residual < CLEAR:
                # Where the past expects it and as sharp as can be: no other pose need be tried.
                return found
        if any(each.certain for each in found):
            return found
        wide = [self._best_refinement(grey, each.camera_from_cube) for each in solutions]
        return [self._judged(*pair) for pair in zip(solutions, wide, strict=True)]

    def _judged(self, solution: CornerSolution, refinement: Refinement | None) -> Candidate:
        """Take the edges' pose where they agree with the corners, else the corners' own."""
        seen = solution.observations
        faces = tuple(each.face.name for each in seen)
        if refinement is None or not self._agree(solution, refinement):
            fine = min(each.size for each in seen) / 6 > FINE_CELL
            return Candidate(
                camera_from_cube=solution.camera_from_cube,
                covariance=solution.covariance + np.diag(FLOOR**2) * 25,
                source="markers",
                faces=faces,
                error=solution.error,
                residual=max(solution.error, 0.5),
                certain=False,
                blurred=fine and len(seen) == 1,
            )
        return Candidate(
            camera_from_cube=refinement.camera_from_cube,
            covariance=refinement.covariance + np.diag(FLOOR**2),
            source="markers",
            faces=faces,
            error=self._solver.error(refinement.camera_from_cube, seen),
            residual=refinement.residual / refinement.support,
            certain=len(seen) > 1 or refinement.support > SEEN_ALONE,
        )

    def _agree(self, solution: CornerSolution, refinement: Refinement) -> bool:
        """Whether the edges moved the pose by less than the corners allow."""
        pose, seen = refinement.camera_from_cube, solution.observations
        if not all(self._solver.looks_at_camera(each.face.name, pose) for each in seen):
            return False
        cell = min(each.size for each in seen) / 6
        limit = solution.error + STRAY * cell if len(seen) > 1 else LONE_CORNERS
        strays = self._solver.error(pose, seen) > limit
        shares = [refinement.shares.get(each.face.name, 0.0) for each in seen]
        whole = max(shares) > (WHOLE_FACE if len(seen) == 1 else SEEN_ALONE)
        return refinement.support > SEEN and whole and not strays

    def _best_refinement(self, grey: Picture, start: Array) -> Refinement | None:
        """Refine precisely and, where that finds too few of the edges, with a wide search."""
        best = self._refiner.refine(grey, start)
        if best is None or best.support < SEEN_ALONE:
            wide = self._refiner.refine(grey, start, wide=True)
            if wide and (best is None or wide.support > best.support):
                return wide
        return best

    def _from_past(self, grey: Picture, last: Sighting, timestamp: float) -> Candidate | None:
        """Look for edges where the cube should be: blur hides markers sooner than edges."""
        expected = prediction.predicted(last, timestamp)
        best = self._best_refinement(grey, expected)
        if best is None or min(best.support, best.inner) < SEEN_ALONE:
            return None
        faces = tuple(face for face, share in best.shares.items() if share > SEEN_ALONE)
        if not prediction.near(last, best.camera_from_cube, timestamp):
            return None
        return Candidate(
            camera_from_cube=best.camera_from_cube,
            covariance=best.covariance + np.diag(BLUR_FLOOR**2),
            source="image",
            faces=faces,
            error=best.residual,
            residual=best.residual / best.support,
            certain=True,
        )

    def _region(self, expected: Array) -> Region | None:
        """Surround the predicted cube, with room for a hand's acceleration."""
        points = self._hull @ expected[:3, :3].T + expected[:3, 3]
        if points[:, 2].min() < NEAREST:
            return None
        pixels = self._projection.pixels(points)
        low, high = pixels.min(axis=0), pixels.max(axis=0)
        margin = 0.35 * float((high - low).max()) + 16
        size = self._projection.size
        left, top = (int(v) for v in np.clip(low - margin, 0, size))
        right, bottom = (int(v) for v in np.clip(high + margin + 1, 0, size))
        if right - left < 32 or bottom - top < 32:
            return None
        return left, top, right, bottom
