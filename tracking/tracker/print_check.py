"""Whether a cube was printed and folded as its file says, and if not, in what it differs.

A look takes the markers of one picture and asks which cube explains all of them: that of the file,
or one that differs from it in a single thing. Only what several looks agree on is reported.
"""

from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Literal

import cv2
import numpy as np

from cubeling.tracking.cube.model import CubeModel, Face
from cubeling.tracking.detection.markers import MarkerDetector, Observation, markers_of
from cubeling.tracking.detection.pose_from_points import CornerPose, CornerPoseSolver
from cubeling.tracking.geometry.arrays import Array, Image
from cubeling.tracking.geometry.frame import Frame
from cubeling.tracking.geometry.image_region import Patch
from cubeling.tracking.geometry.intrinsics import Intrinsics
from cubeling.tracking.geometry.projection import Projection
from cubeling.tracking.geometry.robust_statistics import median_with_error
from cubeling.tracking.refinement.edges.edge_refinement import EdgeRefiner
from cubeling.tracking.refinement.footprint import Footprint

MIN_LOOKS = 3
"""So many looks must agree."""

MAX_DISTANCE = 0.1
"""Corners are where a cube has them, to this share of the marker's side, in a look that speaks."""

MIN_SIDE_PX = 20.0
"""Smaller markers do not tell how they lie."""

SIZES = (0.88, 0.94, 1.0, 1.06, 1.12)
"""Shares of the file's `marker_mm` that are tried first."""

SIZE_STEP = 0.01
"""Steps of the search for the best of them."""

MIN_SIZE_ERROR, MAX_SIZE_ERROR_OF_MEDIAN = 0.022, 0.008
"""A print is of another size if the median of the looks is off by more than the first share, and
has itself a standard error of less than the second: folds move single looks by up to 0.03."""

MIN_SIZE_LOOKS, MAX_SIZE_LOOKS = 4, 12
"""So many looks give a size, and more than the second tell nothing new."""


@dataclass(frozen=True)
class PrintFault:
    """In what a print differs from the file of its cube."""

    kind: Literal["rolled", "swapped", "turned", "mirrored", "inverted", "size"]
    """A marker is rolled on its face; two have changed places; all are turned by half a turn, as
    OpenCV 4 prints AprilTags; all are mirrored, in the print or in the picture; black and white
    are exchanged; or all have another size."""

    faces: tuple[str, ...] = ()
    """Names of the faces that are rolled or swapped; () where it is all of them."""

    roll_deg: int = 0
    """What `roll_deg` of a rolled face should be."""

    marker_mm: float = 0.0
    """What `marker_mm` should be, of another size [mm]."""


class PrintCheck:
    """Checks the print of one cube seen by one camera, in a look now and then."""

    def __init__(self, cube: CubeModel, intrinsics: Intrinsics) -> None:
        self._cube = cube
        self._projection = Projection(intrinsics)
        self._detector = MarkerDetector(cube.dictionary)
        self._printed: dict[PrintFault | None, tuple[CubeModel, CornerPoseSolver]] = {}
        self._refiners: dict[int, EdgeRefiner] = {}
        self._footprint = Footprint(cube, self._projection)
        self._votes: Counter[PrintFault] = Counter()
        self._sizes: list[float] = []
        self._confirmed: set[str] = set()
        self.agreed = 0
        """How many looks the cube of the file has explained."""
        self._sized = [
            (cube, CornerPoseSolver(cube, self._projection))
            for cube in (with_markers(cube, share) for share in SIZES)
        ]

    @property
    def fault(self) -> PrintFault | None:
        """What enough looks agree on; None while they do not, or where the print is right."""
        for fault, votes in self._votes.most_common(1):
            if votes >= MIN_LOOKS and not self._confirmed & set(fault.faces or ("all",)):
                return fault
        if len(self._sizes) < MIN_SIZE_LOOKS:
            return None
        size, error = median_with_error(np.array(self._sizes))
        if abs(size - 1) < MIN_SIZE_ERROR + error or error > MAX_SIZE_ERROR_OF_MEDIAN:
            return None
        return PrintFault("size", marker_mm=round(1000 * self._cube.marker_size * size, 1))

    def look(self, frame: Frame) -> None:
        """Look at a picture in which several sides of the cube may be seen."""
        grey = np.asarray(cv2.cvtColor(frame.image, cv2.COLOR_BGR2GRAY), np.uint8)
        seen = self._read(grey)
        if not seen:
            self._look_for_other_prints(grey)
        if _side_count(seen) < 2:
            return
        if self._solve(None, seen):
            self.agreed += 1
            self._confirmed |= {"all", *(each.face.name for each in seen)}
            self._measure_size(grey, seen)
            return
        explaining = [fault for fault in self._faults(seen) if self._solve(fault, seen)]
        if len(explaining) == 1:
            self._votes[explaining[0]] += 1
        elif not explaining:
            self._measure_size(grey, seen)

    def _read(self, grey: Image) -> list[Observation]:
        """Return the markers of the cube in an image, of those that are there once."""
        found = markers_of(self._cube, self._detector.detect_strictly(grey))
        found = [each for each in found if each.size > MIN_SIDE_PX]
        counts = Counter(each.face.name for each in found)
        return [each for each in found if counts[each.face.name] == 1]

    def _look_for_other_prints(self, grey: Image) -> None:
        """Look for mirrored and for inverted markers where no right ones are in view."""
        mirrored = np.ascontiguousarray(grey[:, ::-1])
        if _side_count(self._read(mirrored)) >= 2:
            self._votes[PrintFault("mirrored")] += 1
        elif _side_count(self._read(np.asarray(255 - grey, np.uint8))) >= 2:
            self._votes[PrintFault("inverted")] += 1

    def _faults(self, seen: Sequence[Observation]) -> Iterator[PrintFault]:
        """Yield the faults that may explain what was seen."""
        if "APRILTAG" in self._cube.dictionary:
            yield PrintFault("turned")
        names = [each.face.name for each in seen]
        for face in self._cube.faces:
            if face.name in names:
                for turn in (90, 180, 270):
                    yield PrintFault("rolled", (face.name,), (face.roll_deg + turn) % 360)
        for number, one in enumerate(self._cube.faces):
            for other in self._cube.faces[:number]:
                if one.name in names or other.name in names:
                    yield PrintFault("swapped", (other.name, one.name))

    def _solve(self, fault: PrintFault | None, seen: Sequence[Observation]) -> CornerPose | None:
        """Return the pose of the cube with a fault if it explains all markers; None if not."""
        if fault not in self._printed:
            cube = self._cube if fault is None else cube_with(self._cube, fault)
            self._printed[fault] = cube, CornerPoseSolver(cube, self._projection)
        return _explaining_pose(*self._printed[fault], seen)

    def _measure_size(self, grey: Image, seen: Sequence[Observation]) -> None:
        """Measure the size of the markers on their faces, by all edges in two and more of these.

        Edges tell it from bloom, by which white grows over black. A lens that is wrong by a factor
        of 1.7 moves it by no more than a hundredth.
        """
        if len(self._sizes) >= MAX_SIZE_LOOKS:
            return
        found = [
            (solved.error, share, solved.camera_from_cube)
            for share, sized in zip(SIZES, self._sized, strict=True)
            if (solved := _explaining_pose(*sized, seen)) is not None
        ]
        if not found:
            return
        _, share, pose = min(found, key=lambda each: each[0])
        patch = self._footprint.crop(grey, pose, np.arange(256, dtype=np.float32))
        step, residuals = round((share - 1) / SIZE_STEP), dict[int, float]()
        while patch is not None:
            for near in (step - 1, step, step + 1):
                if near not in residuals:
                    residuals[near] = self._residual(patch, pose, near)
            low, middle, high = (residuals[near] for near in (step - 1, step, step + 1))
            if not np.isfinite([low, middle, high]).all():
                return
            if middle <= min(low, high):
                bend = low - 2 * middle + high
                vertex = step + 0.5 * (low - high) / max(bend, 1e-9)
                self._sizes.append(1 + SIZE_STEP * float(vertex))
                return
            step += -1 if low < high else 1

    def _residual(self, patch: Patch, pose: Array, step: int) -> float:
        if step not in self._refiners:
            cube = with_markers(self._cube, 1 + SIZE_STEP * step)
            self._refiners[step] = EdgeRefiner(cube, self._projection)
        found = self._refiners[step].refine(patch, pose)
        return np.inf if found is None else found.residual**2 / found.support


def cube_with(cube: CubeModel, fault: PrintFault) -> CubeModel:
    """Return the cube as it was printed with a fault that moves or turns markers."""
    if fault.kind == "turned":
        faces = tuple(_roll_face(face, 180) for face in cube.faces)
    elif fault.kind == "rolled":
        name = fault.faces[0]
        turn = fault.roll_deg - cube.face(name).roll_deg
        faces = tuple(_roll_face(face, turn) if face.name == name else face for face in cube.faces)
    elif fault.kind == "swapped":
        one, other = (cube.face(name) for name in fault.faces)
        ids = {one.name: other.marker_id, other.name: one.marker_id}
        faces = tuple(
            replace(face, marker_id=ids.get(face.name, face.marker_id)) for face in cube.faces
        )
    else:
        faces = cube.faces
    return replace(cube, faces=faces)


def _roll_face(face: Face, degrees: int) -> Face:
    """Return a face with its marker turned clockwise seen from outside, by quarters."""
    corners = np.roll(face.corners, -(degrees // 90), axis=0)
    return replace(face, corners=corners, roll_deg=(face.roll_deg + degrees) % 360)


def with_markers(cube: CubeModel, share: float) -> CubeModel:
    """Return a cube whose markers have another size about the same middles."""
    faces = []
    for face in cube.faces:
        middle = face.corners.mean(axis=0)
        faces.append(replace(face, corners=middle + share * (face.corners - middle)))
    return replace(cube, marker_size=cube.marker_size * share, faces=tuple(faces))


def _explaining_pose(
    cube: CubeModel, solver: CornerPoseSolver, seen: Sequence[Observation]
) -> CornerPose | None:
    """Return a pose of a cube that explains all markers, if there is one."""
    faces = {face.marker_id: face for face in cube.faces}
    own = [replace(each, face=faces[each.face.marker_id]) for each in seen]
    for pose in solver.solve(own)[:1]:
        size = min(each.size for each in seen)
        if len(pose.observations) == len(seen) and pose.error < MAX_DISTANCE * size:
            return pose
    return None


def _side_count(seen: Sequence[Observation]) -> int:
    return len({each.face.side for each in seen})
