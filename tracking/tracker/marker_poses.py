"""Candidate poses from the markers of one frame, refined on the edges."""

from tracking.cube.model import CubeModel
from tracking.detection.markers import Observation
from tracking.detection.pose_from_points import CornerPose, CornerPoseSolver
from tracking.geometry import se3
from tracking.geometry.arrays import Array
from tracking.geometry.image_region import Patch
from tracking.geometry.projection import Projection
from tracking.refinement.candidate import Candidate
from tracking.refinement.edge_search import EdgeMatch, EdgeSearch

MAX_CORNER_DISTANCE_CELLS, MAX_LONE_CORNER_DISTANCE_PX = 1.0, 1.15
"""Edges and corners must agree to this, the second where only one marker was read: blur moves its
corners away from the edges, and would put the cube centimetres too near or too far."""

MIN_EDGE_SUPPORT = 0.3
"""Share of the edges in view that must be found where markers were read; fingers cover the rest."""

MIN_FACE_SUPPORT, MIN_LONE_FACE_SUPPORT = 0.6, 0.85
"""The same for the best of the faces whose markers were read, and for the only one: blur that hides
the other faces leaves less of it, fingers that do so leave all of it."""

MIN_SHARPNESS = 0.75
"""Edges that are duller than this show a blurred image, which is aligned as one."""

MIN_FINE_CELL_PX = 4.0
"""Cells larger than this have edges that a sharp image shows."""

CELLS_PER_MARKER = 6
"""Cells along a marker of 4×4 bits and its border."""


class MarkerPoses:
    """Proposes poses of one cube from the corners of its markers, refined and proved by `edges`."""

    def __init__(self, cube: CubeModel, projection: Projection, edges: EdgeSearch) -> None:
        self._solver = CornerPoseSolver(cube, projection)
        self._edges = edges

    def find(
        self, patch: Patch, observations: list[Observation], expected: Array | None
    ) -> list[Candidate]:
        """Propose up to two poses for the markers of an image; `expected` is the predicted one."""
        solutions = self._solver.solve(observations, expected)
        solutions = [each for each in solutions if not _is_contradicted(each, observations)]
        if expected is not None:
            solutions.sort(key=lambda each: se3.angle_between(each.camera_from_cube, expected))
        matches = [self._edges.match(patch, each.camera_from_cube) for each in solutions]
        found = [self._candidate(*each) for each in zip(solutions, matches, strict=True)]
        if any(each.certain for each in found):
            return self._with_mirrored(patch, found)
        return [
            self._candidate(solution, self._widely_matched(patch, solution, match))
            for solution, match in zip(solutions, matches, strict=True)
        ]

    def _with_mirrored(self, patch: Patch, found: list[Candidate]) -> list[Candidate]:
        """Add the other pose of a single face, where the corners alone did not propose it."""
        if len(found) > 1 or len(found[0].faces) > 1:
            return found
        other = self._edges.search(patch, self._edges.mirrored_pose(found[0]))
        return [*found, other] if other and not found[0].same_pose(other) else found

    def _widely_matched(
        self, patch: Patch, solution: CornerPose, precise: EdgeMatch | None
    ) -> EdgeMatch | None:
        """Search widely where the precise search found too few of the edges."""
        support = precise.refinement.support if precise else 0.0
        if support >= MIN_FACE_SUPPORT:
            return precise
        wide = self._edges.match(patch, solution.camera_from_cube, wide=True)
        return wide if wide and wide.refinement.support > support else precise

    def _candidate(self, solution: CornerPose, match: EdgeMatch | None) -> Candidate:
        """Take the pose of the edges where they agree with the corners, else the corners' own."""
        seen = solution.observations
        faces = tuple(each.face.name for each in seen)
        if match is None or not self._agree(solution, match):
            fine = min(each.size for each in seen) / CELLS_PER_MARKER > MIN_FINE_CELL_PX
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
        refined = match.refinement
        return Candidate(
            camera_from_cube=refined.camera_from_cube,
            covariance=match.covariance,
            source="markers",
            faces=faces,
            error=self._solver.error(refined.camera_from_cube, seen),
            residual=refined.residual / refined.support,
            certain=refined.sharpness > MIN_SHARPNESS and match.proved,
            measurements=refined.line_count,
        )

    def _agree(self, solution: CornerPose, match: EdgeMatch) -> bool:
        """Whether the edges moved the pose by less than the corners allow."""
        refined, seen = match.refinement, solution.observations
        pose = refined.camera_from_cube
        if not all(self._solver.looks_at_camera(each.face.name, pose) for each in seen):
            return False
        alone = len(seen) == 1
        cell = min(each.size for each in seen) / CELLS_PER_MARKER
        limit = solution.error + MAX_CORNER_DISTANCE_CELLS * cell
        far = self._solver.error(pose, seen) > (MAX_LONE_CORNER_DISTANCE_PX if alone else limit)
        best = max(refined.face_support.get(each.face.name, 0.0) for each in seen)
        supported = best > (MIN_LONE_FACE_SUPPORT if alone else MIN_FACE_SUPPORT)
        return refined.support > MIN_EDGE_SUPPORT and supported and not far


def _is_contradicted(solution: CornerPose, observations: list[Observation]) -> bool:
    """Whether other markers contradict a pose that rests on one: those of a flat sheet do."""
    return len(solution.observations) == 1 < len({each.face.name for each in observations})
