"""Poses that the markers of one frame propose, refined on edges."""

import numpy as np
from numpy.typing import NDArray

from tracking.cube.model import CubeModel
from tracking.detection.markers import Observation
from tracking.detection.pose_from_points import CornerSolution, CornerSolver
from tracking.geometry import se3
from tracking.geometry.image_region import Patch
from tracking.geometry.projection import Projection
from tracking.refinement.edge_refinement import Refinement
from tracking.tracker.candidate import Candidate, close
from tracking.tracker.local_search import Follower

Array = NDArray[np.float64]

STRAY = 1.0
"""Edges and corners must agree to this share of a cell, or the edges found something else."""

LONE_CORNERS = 1.15
"""Where only one marker was read, its corners must be as near as this to the edges [px]: blur pulls
the two apart, and would put the cube centimetres too near or too far."""

SEEN = 0.3
"""Share of the edges in view that must be found beside the markers; fingers cover the rest."""

SEEN_ALONE = 0.6
"""The same where no marker was read, so that the edges alone prove that this is the cube."""

WHOLE_FACE = 0.85
"""The same for the edges of the only face whose marker was read: blur that hides the other faces
leaves less of it, fingers that do so leave all of it."""

STEEP = 0.75
"""Edges that are duller than this show a blurred picture: it is aligned as one, since blur of which
nothing is known puts a lone face centimetres too near or too far."""

FINE_CELL = 4.0
"""Cells larger than this [px] have edges that a sharp picture shows."""


class CandidateFinder:
    """Proposes poses of one cube seen by one camera."""

    def __init__(self, cube: CubeModel, projection: Projection, follower: Follower) -> None:
        self._solver = CornerSolver(cube, projection)
        self._follower = follower

    def find(
        self, patch: Patch, observations: list[Observation], expected: Array | None
    ) -> list[Candidate]:
        """Propose up to two poses for the markers that were read in a picture.

        Parameters
        ----------
        patch
            The picture.
        observations
            The markers.
        expected
            Where the cube should be by its past, (4, 4), if that is known.
        """
        solutions = self._solver.solve(observations, expected)
        solutions = [each for each in solutions if not _contradicted(each, observations)]
        if expected is not None:
            solutions.sort(key=lambda each: se3.angle_between(each.camera_from_cube, expected))
        refine = self._follower.refiner.refine
        found = [
            self._judged(patch, each, refine(patch, each.camera_from_cube)) for each in solutions
        ]
        if any(each.certain for each in found):
            return self._with_mirrored(patch, found)
        wide = [self._best_refinement(patch, each.camera_from_cube) for each in solutions]
        return [self._judged(patch, *pair) for pair in zip(solutions, wide, strict=True)]

    def _with_mirrored(self, patch: Patch, found: list[Candidate]) -> list[Candidate]:
        """Add the other pose of a single face, where the corners alone did not propose it."""
        if len(found) > 1 or len(found[0].faces) > 1:
            return found
        other = self._follower.mirrored(patch, found[0])
        return [*found, other] if other and not close(found[0], other) else found

    def _judged(
        self, patch: Patch, solution: CornerSolution, refinement: Refinement | None
    ) -> Candidate:
        """Take the edges' pose where they agree with the corners, else the corners' own."""
        seen = solution.observations
        faces = tuple(each.face.name for each in seen)
        if refinement is None or not self._agree(solution, refinement):
            fine = min(each.size for each in seen) / 6 > FINE_CELL
            return Candidate(
                camera_from_cube=solution.camera_from_cube,
                covariance=solution.covariance,
                source="markers",
                faces=faces,
                error=solution.error,
                residual=max(solution.error, 0.5),
                certain=False,
                blurred=fine or len(seen) == 1,
            )
        return Candidate(
            camera_from_cube=refinement.camera_from_cube,
            covariance=self._follower.doubted(refinement, None),
            source="markers",
            faces=faces,
            error=self._solver.error(refinement.camera_from_cube, seen),
            residual=refinement.residual / refinement.support,
            certain=refinement.steep > STEEP and self._follower.proved(patch, refinement),
            lines=refinement.lines,
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

    def _best_refinement(self, patch: Patch, start: Array) -> Refinement | None:
        """Refine precisely and, where that finds too few of the edges, with a wide search."""
        best = self._follower.refiner.refine(patch, start)
        if best is None or best.support < SEEN_ALONE:
            wide = self._follower.refiner.refine(patch, start, wide=True)
            if wide and (best is None or wide.support > best.support):
                return wide
        return best


def _contradicted(solution: CornerSolution, observations: list[Observation]) -> bool:
    """Whether a pose rests on one marker while others of the same cube say that it is elsewhere.

    A cube cut open and laid flat, its printed sheet, shows several; a cube never does.
    """
    return len(solution.observations) == 1 < len({each.face.name for each in observations})
