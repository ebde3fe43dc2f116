"""Candidate poses from the markers of one frame, weighed by all faces in view."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from cubeling.tracking.cube.model import CubeModel, side_of
from cubeling.tracking.detection.markers import Observation
from cubeling.tracking.detection.pose_from_points import CornerPose, CornerPoseSolver
from cubeling.tracking.geometry import se3
from cubeling.tracking.geometry.arrays import Array, Floats, Image
from cubeling.tracking.geometry.projection import Projection
from cubeling.tracking.refinement.candidate import Candidate
from cubeling.tracking.refinement.cell_search import CellMatch, CellRun, CellSearch
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

MAX_TURNED_DISTANCE = 3.0
"""A marker of a face that a pose turns away is of the same paper, and not of another cube, where it
is this near to the middle of the cube, in sides: a sheet reaches two faces beyond those found."""


MIN_LONE_INNER = 0.6
"""Correlation inside the border below which a lone marker is another one: its other lean, which
looks nearly the same, does not reach what is needed."""


@dataclass(frozen=True)
class CellComparison:
    """What the cells say of one proposed pose."""

    candidates: tuple[Candidate, ...] = ()
    """The pose, measured; none where markers contradict it."""

    absent: bool = False
    """Whether it rests on a lone marker that is not there, at whatever lean."""


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

    def solve(
        self, observations: list[Observation], expected: Array | None = None
    ) -> list[CornerPose]:
        """Propose up to two poses for the corners of markers; `expected` is the predicted pose."""
        return self._solver.solve(observations, expected)

    def find_agreed(
        self,
        image: Image,
        solutions: Sequence[CornerPose],
        observations: list[Observation],
        tone: Floats,
    ) -> Candidate | None:
        """Find the pose that the edges of several faces agree on in an image, (H, W) grey.

        `solutions` are the proposed poses, `tone` is the light for each grey value, (256,).
        """
        for solution in solutions:
            agreed = self._agreement(image, solution, observations, tone)
            if agreed is not None:
                return agreed
        return None

    def compare_cells(
        self,
        image: Image,
        solution: CornerPose,
        observations: list[Observation],
        tone: Floats,
        run: CellRun | None = None,
    ) -> CellComparison | CellRun:
        """Align the cells of all faces near a proposed pose.

        Each call takes one step, and returns how far it has come until it is done; `run` is what
        the last call returned.
        """
        if run is None:
            read = tuple(each.face.name for each in solution.observations)
            run = self._cells.begin(image, solution.camera_from_cube, tone, read, exact=True)
        if not run.done:
            run = self._cells.advance(run)
        if not run.done:
            return run
        found = self._candidates(image, solution, run.match, observations, tone)
        return CellComparison(tuple(found), _is_absent(solution, run.match))

    def mirror(self, solution: CornerPose, found: Sequence[Candidate]) -> list[CornerPose]:
        """Propose the other lean of a single face that was found, the best first; else nothing."""
        if not found or not found[0].certain or not found[0].lone:
            return []
        start = self._edges.mirrored_pose(found[0])
        if any(_near(each.camera_from_cube, start) for each in found):
            return []
        own = tuple(each for each in solution.observations if each.face.name in found[0].faces)
        return [replace(solution, camera_from_cube=start, observations=own)]

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
            if not seen:  # the other lean of a face that no marker was read of
                return []
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
        candidate = match.candidate
        if solution.observations:  # else the other lean of a face that no marker was read of
            candidate = replace(candidate, error=self._solver.error(pose, solution.observations))
        if candidate.lone:
            smeared = MAX_LONE_BLUR_CELLS * self._footprint.pixels_per_cell(pose)
            blurred = candidate.blur > max(MAX_LONE_BLUR_PX, smeared)
            # Another face may be found than the one that the pose was measured on.
            alike = match.alignment.correlations.get(candidate.faces[0], 0.0)
            unlike = alike < MIN_LONE_CORRELATION
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
        return any(
            self._contradicts(pose, each, lone=len({side_of(face) for face in faces}) == 1)
            for each in observations
            if each.face.name not in faces
        )

    def _contradicts(self, pose: Array, seen: Observation, *, lone: bool) -> bool:
        if self._solver.looks_at_camera(seen.face.name, pose):
            far = np.inf if lone else MAX_OWN_DISTANCE
            return MAX_CORNER_DISTANCE < self._distance(pose, seen) <= far
        # A face that the pose turns away cannot be read anywhere near.
        middle = self._projection.project(pose[None, :3, 3])[0]
        away = float(np.linalg.norm(seen.corners.mean(axis=0) - middle)) / seen.size
        return lone or away <= MAX_TURNED_DISTANCE

    def _distance(self, pose: Array, seen: Observation) -> float:
        """How far most corners of a marker are from where a pose puts them, by its side."""
        points = seen.face.corners @ pose[:3, :3].T + pose[:3, 3]
        away = np.linalg.norm(self._projection.project(points) - seen.corners, axis=1)
        return float(np.median(away)) / seen.size


def _is_absent(solution: CornerPose, match: CellMatch | None) -> bool:
    """Whether a pose rests on a lone marker that the cells show to be another one."""
    if len(solution.observations) != 1 or match is None:
        return len(solution.observations) == 1
    inner = match.alignment.inner.get(solution.observations[0].face.name, 0.0)
    return not match.proved and inner < MIN_LONE_INNER


def _near(pose: Array, other: Array) -> bool:
    return bool(se3.angle_between(pose, other) < NEAR_ANGLE)
