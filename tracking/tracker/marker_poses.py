"""Candidate poses from the markers of one frame, weighed by all faces in view."""

from dataclasses import replace

import numpy as np

from cubeling.tracking.cube.model import CubeModel, side_of
from cubeling.tracking.detection.markers import Observation
from cubeling.tracking.detection.pose_from_points import CornerPose, CornerPoseSolver
from cubeling.tracking.geometry import se3
from cubeling.tracking.geometry.arrays import Array, Floats, Image
from cubeling.tracking.geometry.projection import Projection
from cubeling.tracking.refinement.candidate import Candidate
from cubeling.tracking.refinement.cell_search import CellMatch, CellSearch
from cubeling.tracking.refinement.edge_search import EdgeSearch
from cubeling.tracking.refinement.footprint import Footprint

MIN_EDGE_CELL_PX = 6.0
"""From this size of a cell on, single edges are more precise than whole cells, whose blur and light
differ from their model."""

MIN_AGREED_CELL_PX = 3.0
"""Size of a cell from which on edges alone prove a pose that several faces agree on."""

MIN_FACE_SUPPORT = 0.6
"""Share of the edges of a marker that was read that must be found, of two markers at least."""

MIN_AGREEMENT, MIN_BEST_AGREEMENT = 0.85, 0.95
"""Share of the cells of such a face that must be as expected, and of the best of them: half of the
cells are alike on all markers."""

MIN_SHARPNESS = 0.75
"""Edges that are duller than this show a blurred image."""

MAX_EDGE_STEP_CELLS = 0.5
"""Edges may move a pose that the cells have found by this much."""

MIN_FINE_CELL_PX = 4.0
"""Cells larger than this have edges that a sharp image shows."""

MAX_LONE_BLUR_PX, MAX_LONE_BLUR_CELLS = 1.5, 0.22
"""A single face whose image is blurred by more than both, one standard deviation, does not tell its
lean: motion blurs in one direction, a lens in all."""

MIN_LONE_CORRELATION = 0.95
"""Correlation of a single face from which on it tells its lean: what covers or shades a part of it
tilts it."""

MAX_CORNER_DISTANCE = 0.1
"""A marker that was read lies where a pose puts it, to this share of its side; by most of its
corners, as one of them may be hidden."""

NEAR_ANGLE = np.deg2rad(8)
"""A pose that is found this near to where a search would start is its result [rad]."""

MAX_OWN_DISTANCE = 1.0
"""A marker this near to where a pose puts it, in sides, is that of the same cube."""


class MarkerPoses:
    """Proposes poses of one cube from its markers, aligned and weighed by `cells`."""

    def __init__(
        self, cube: CubeModel, projection: Projection, edges: EdgeSearch, cells: CellSearch
    ) -> None:
        self._solver = CornerPoseSolver(cube, projection)
        self._projection = projection
        self._footprint = Footprint(cube, projection)
        self._cells_per_side = round(cube.marker_size / self._footprint.cell)
        self._edges = edges
        self._cells = cells

    def find(
        self, image: Image, observations: list[Observation], expected: Array | None, tone: Floats
    ) -> list[Candidate]:
        """Propose up to two poses for the markers of an image, (H, W) grey.

        `expected` is the predicted pose, `tone` the light for each grey value, (256,).
        """
        found: list[Candidate] = []
        solutions = self._solver.solve(observations, expected)
        for solution in solutions:
            agreed = self._agreement(image, solution, observations, tone)
            if agreed is not None:
                return [agreed]
        for solution in solutions:
            read = tuple(each.face.name for each in solution.observations)
            match = self._cells.search(image, solution.camera_from_cube, tone, read)
            found += self._candidates(image, solution, match, observations, tone)
        best = min(found, key=lambda each: each.rank, default=None)
        if best is not None and best.certain and best.lone:
            # The face may lean the other way, whether or not the corners proposed that.
            start = self._edges.mirrored_pose(best)
            if any(_near(each.camera_from_cube, start) for each in found):
                return found
            match = self._cells.search(image, start, tone, best.faces)
            solution = replace(solution, camera_from_cube=start)
            found += self._candidates(image, solution, match, observations, tone)
        return found

    def _agreement(
        self,
        image: Image,
        solution: CornerPose,
        observations: list[Observation],
        tone: Floats,
    ) -> Candidate | None:
        """Take the pose of the edges where several faces agree on it: no other can be right."""
        seen, pose = solution.observations, solution.camera_from_cube
        if self._footprint.pixels_per_cell(pose) < MIN_AGREED_CELL_PX:
            return None
        patch = self._footprint.crop(image, pose, tone)
        match = self._edges.match(patch, pose) if patch else None
        if match is None or not match.proved:
            return None
        refined = match.refinement
        faces = tuple(
            face
            for face, share in refined.face_support.items()
            if share > MIN_FACE_SUPPORT and match.reading.agreement.get(face, 0.0) > MIN_AGREEMENT
        )
        if len({side_of(face) for face in faces}) < 2 or refined.sharpness < MIN_SHARPNESS:
            return None
        if match.reading.best < MIN_BEST_AGREEMENT:
            return None
        if self._is_contradicted(refined.camera_from_cube, faces, observations):
            return None
        return Candidate(
            camera_from_cube=refined.camera_from_cube,
            covariance=match.covariance,
            source="markers",
            faces=faces,
            error=self._solver.error(refined.camera_from_cube, seen),
            residual=refined.residual,
            certain=True,
            agreed=True,
        )

    def _candidates(
        self,
        image: Image,
        solution: CornerPose,
        match: CellMatch | None,
        observations: list[Observation],
        tone: Floats,
    ) -> list[Candidate]:
        """Take the pose of cells or edges where they show the cube, else that of the corners.

        There is none where other markers contradict a pose that rests on one.
        """
        if match is None or not match.proved:
            seen = solution.observations
            fine = min(each.size for each in seen) / self._cells_per_side > MIN_FINE_CELL_PX
            if len(seen) == 1 < len({each.face.name for each in observations}):
                return []
            corners = Candidate(
                camera_from_cube=solution.camera_from_cube,
                covariance=solution.covariance,
                source="markers",
                faces=tuple(each.face.name for each in seen),
                error=solution.error,
                residual=max(solution.error, 0.5),
                certain=False,
                blurred=fine or len(seen) == 1,
                evidence=match.evidence if match else None,
            )
            return [corners]
        pose = match.alignment.camera_from_cube
        if self._is_contradicted(pose, match.found, observations):
            return []
        error = self._solver.error(pose, solution.observations)
        candidate = replace(match.candidate, error=error)
        if candidate.lone:
            smeared = MAX_LONE_BLUR_CELLS * self._footprint.pixels_per_cell(pose)
            blurred = candidate.blur > max(MAX_LONE_BLUR_PX, smeared)
            unlike = match.alignment.correlations[candidate.faces[0]] < MIN_LONE_CORRELATION
            if blurred or unlike:
                return [replace(candidate, certain=False, blurred=blurred)]
        return [self._on_edges(image, candidate, tone)]

    def _on_edges(self, image: Image, candidate: Candidate, tone: Floats) -> Candidate:
        """Refine a pose on the edges where these are far enough apart; they tell screens, too."""
        pose = candidate.camera_from_cube
        cell = self._footprint.pixels_per_cell(pose)
        if cell < MIN_AGREED_CELL_PX or not candidate.certain:
            return candidate
        patch = self._footprint.crop(image, pose, tone)
        match = self._edges.match(patch, pose) if patch else None
        if match is None:
            return candidate
        if not match.rigid or (cell > MIN_EDGE_CELL_PX and not match.proved):
            return replace(candidate, certain=False)
        refined = match.refinement.camera_from_cube
        step = self._footprint.blur_extent(se3.delta(pose, refined))
        if cell < MIN_EDGE_CELL_PX or step > MAX_EDGE_STEP_CELLS:
            return candidate
        return replace(
            candidate,
            camera_from_cube=refined,
            covariance=match.covariance,
            residual=match.refinement.residual / match.refinement.support,
            measurements=match.refinement.line_count,
        )

    def _is_contradicted(
        self, pose: Array, faces: tuple[str, ...], observations: list[Observation]
    ) -> bool:
        """Whether a marker was read where the cube has none: that of a flat sheet, of a picture.

        Beside two faces that are found only a near one contradicts: a far one is another cube's.
        """
        far = np.inf if len({side_of(face) for face in faces}) == 1 else MAX_OWN_DISTANCE
        distances = [
            self._distance(pose, each) for each in observations if each.face.name not in faces
        ]
        return any(MAX_CORNER_DISTANCE < each <= far for each in distances)

    def _distance(self, pose: Array, seen: Observation) -> float:
        """How far most corners of a marker are from where a pose puts them, by its side."""
        if not self._solver.looks_at_camera(seen.face.name, pose):
            return np.inf
        points = seen.face.corners @ pose[:3, :3].T + pose[:3, 3]
        away = np.linalg.norm(self._projection.project(points) - seen.corners, axis=1)
        return float(np.median(away)) / seen.size


def _near(pose: Array, other: Array) -> bool:
    return bool(se3.angle_between(pose, other) < NEAR_ANGLE)
