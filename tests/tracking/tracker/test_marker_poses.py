"""Poses from markers: proved by two faces at once, and contradicted by markers elsewhere."""

from dataclasses import replace

import cv2
import numpy as np
import pytest
from numpy.typing import NDArray

from cubeling.tracking.cube.marker import marker_cells
from cubeling.tracking.cube.model import CubeModel
from cubeling.tracking.detection.markers import Marker, MarkerDetector, Observation, markers_of
from cubeling.tracking.detection.pose_from_points import CornerPose
from cubeling.tracking.geometry.projection import Projection
from cubeling.tracking.refinement.camera_model import ToneCurve
from cubeling.tracking.refinement.candidate import Candidate
from cubeling.tracking.refinement.cell_search import CellRun, CellSearch
from cubeling.tracking.refinement.edge_search import EdgeSearch
from cubeling.tracking.tracker.marker_poses import MarkerPoses
from tests.tracking.drawn import CAMERA, held, off, photograph, scene

Array = NDArray[np.float64]
Picture = NDArray[np.uint8]

CUBE = CubeModel.load("locomotion")
PROJECTION = Projection(CAMERA)
DETECTOR = MarkerDetector(CUBE.dictionary)
LIGHT = ToneCurve().table
FAR = held(0.5, 0.6, 0.1, at=(0.2, -0.12, 0.6))
"""Place of another cube, away from the one in the middle."""


class CountingCells(CellSearch):
    """Counts how often the cells are searched."""

    count = 0

    def begin(self, *arguments, **options) -> CellRun:
        self.count += 1
        return super().begin(*arguments, **options)


def poses_by(cells: CellSearch) -> MarkerPoses:
    return MarkerPoses(CUBE, PROJECTION, EdgeSearch(CUBE, PROJECTION), cells)


def find(
    picture: Picture, seen: list[Observation], cells: CellSearch | None = None
) -> tuple[list[Candidate], int]:
    """Poses for the markers of a picture, and how often the cells were searched."""
    counting = cells or CountingCells(CUBE, PROJECTION)
    poses = poses_by(counting)
    waiting = poses.solve(seen)
    agreed = poses.find_agreed(picture, waiting, seen, LIGHT)
    if agreed is not None:
        return [agreed], getattr(counting, "count", 0)
    found: list[Candidate] = []
    mirrored = False
    while waiting:
        solution, *waiting = waiting
        told = poses.compare_cells(picture, solution, seen, LIGHT)
        while isinstance(told, CellRun):
            told = poses.compare_cells(picture, solution, seen, LIGHT, told)
        found = sorted([*found, *told.candidates], key=lambda each: each.rank)
        if not waiting and not mirrored:
            waiting, mirrored = poses.mirror(solution, found), True
    return found, getattr(counting, "count", 0)


def drawn(pose: Array, *faces: str) -> Picture:
    """Grey picture of the cube, or of some of its faces, (480, 640)."""
    kept = tuple(face for face in CUBE.faces if not faces or face.name in faces)
    return photograph(scene((replace(CUBE, faces=kept), pose)))[..., 0]


def read(picture: Picture) -> list[Observation]:
    return markers_of(CUBE, DETECTOR.detect(picture))


def at(pose: Array, name: str) -> Observation:
    """A marker where the cube at some pose would show it."""
    face = CUBE.face(name)
    return Observation(face, PROJECTION.project(face.corners @ pose[:3, :3].T + pose[:3, 3]))


@pytest.mark.parametrize("turn", [(0.5, 0.6, 0.1), (0.8, -0.5, 0.4), (0.4, 2.2, -0.3)])
def test_two_faces_on_their_edges_are_accepted_at_once(turn: tuple[float, float, float]) -> None:
    pose = held(*turn)
    picture = drawn(pose)
    found, searches = find(picture, read(picture))
    assert searches == 0
    assert len(found) == 1
    assert found[0].certain
    assert len(found[0].faces) >= 2
    assert off(found[0].camera_from_cube, pose)[0] < 0.1


@pytest.mark.parametrize("distance", [0.5, 1.0, 1.8])
def test_cells_prove_a_cube_that_is_far_or_shows_one_face(distance: float) -> None:
    for pose, faces in ((held(), ("front",)), (held(at=(0.0, 0.0, distance)), ())):
        picture = drawn(pose, *faces)
        found, _ = find(picture, [at(pose, "front")])
        best = min(found, key=lambda each: each.rank)
        assert best.certain
        assert off(best.camera_from_cube, pose)[1] < 2


def test_both_leans_of_a_single_face_are_weighed() -> None:
    """Whether or not the corners propose both; the true one is not clearly worse."""
    pose = held(0.25, 0.1, 0.2, at=(0.0, 0.0, 1.0))
    picture = drawn(pose, "front")
    found, searches = find(picture, [at(pose, "front")])
    assert searches >= 2
    angles = [off(each.camera_from_cube, pose)[1] for each in found if each.certain]
    assert min(angles) < 2
    assert max(angles) > 15
    right = found[int(np.argmin([off(each.camera_from_cube, pose)[1] for each in found]))]
    assert not any(each.clearly_better_than(right) for each in found)


def test_a_single_face_that_is_covered_in_part_proves_nothing() -> None:
    """What covers it would tilt it."""
    pose = held(0.25, 0.1, 0.2, at=(0.0, 0.0, 0.6))
    picture = drawn(pose, "front")
    seen = at(pose, "front")
    assert any(each.certain for each in find(picture, [seen])[0])
    corners = seen.corners
    strip = np.stack([corners[0], corners[1], *(0.75 * corners[1::-1] + 0.25 * corners[2:])])
    covered = cv2.fillConvexPoly(picture.copy(), np.rint(strip).astype(np.int32), (170.0,))
    found, _ = find(np.asarray(covered, np.uint8), [seen])
    assert found
    assert not any(each.certain for each in found)


def sheet(lean: float) -> tuple[Picture, list[Observation]]:
    """Two faces of the cube side by side on flat paper, and their markers."""
    cells = [
        np.pad(marker_cells(CUBE.dictionary, CUBE.face(name).marker_id), 1)
        for name in ("front", "right")
    ]
    light = np.where(np.hstack(cells), 0.04, 0.75).astype(np.float32)
    light = np.kron(light, np.ones((16, 16), np.float32))
    pose = held(lean, 0.2, 0.1, at=(0.0, 0.0, 0.4))
    half = CUBE.edge
    # As the front's plane: x to the right, y up in the cube's frame.
    corners = np.array([(-half, half / 2), (half, half / 2), (half, -half / 2), (-half, -half / 2)])
    points = np.pad(corners, ((0, 0), (0, 1))) @ pose[:3, :3].T + pose[:3, 3]
    height, width = light.shape
    texels = np.array([(0, 0), (width, 0), (width, height), (0, height)]) - 0.5
    pixels = PROJECTION.project(points).astype(np.float32)
    plane = cv2.getPerspectiveTransform(texels.astype(np.float32), pixels)
    fine = np.array([[3, 0, 1], [0, 3, 1], [0, 0, 1.0]]) @ plane
    large = cv2.warpPerspective(light, fine, (1920, 1440), flags=cv2.INTER_AREA, borderValue=0.2)
    small = cv2.resize(large, CAMERA.size, interpolation=cv2.INTER_AREA)
    soft = np.asarray(cv2.GaussianBlur(small, (0, 0), 0.6), np.float32)
    picture = photograph(soft)[..., 0]
    return picture, read(picture)


@pytest.mark.parametrize("lean", [0.0, 0.3, 0.8])
def test_the_markers_of_a_flat_sheet_contradict_each_other(lean: float) -> None:
    picture, seen = sheet(lean)
    assert {each.face.name for each in seen} == {"front", "right"}  # or this would prove nothing
    assert not any(each.certain for each in find(picture, seen)[0])


def test_another_marker_contradicts_a_lone_face_wherever_it_is() -> None:
    pose = held(0.4, 0.2, 0.1)
    picture = drawn(pose, "front")
    front = at(pose, "front")
    assert any(each.certain for each in find(picture, [front])[0])
    for elsewhere in (at(FAR, "right"), replace(at(pose, "top"), corners=front.corners + 90.0)):
        assert not any(each.certain for each in find(picture, [front, elsewhere])[0])


def test_beside_two_faces_only_a_near_marker_contradicts() -> None:
    """A far one is another cube's, or clutter."""
    pose = held()
    picture = drawn(pose, "front", "top")
    two = [at(pose, "front"), at(pose, "top")]
    right = at(pose, "right")
    far, near = (replace(right, corners=right.corners + shift) for shift in (150.0, 25.0))
    for other, sure in ((right, True), (far, True), (near, False)):
        found, _ = find(picture, [*two, other])
        together = [each for each in found if each.certain and set(each.faces) >= {"front", "top"}]
        assert bool(together) == sure


def test_markers_of_other_cubes_are_left_out() -> None:
    """A list of them may hold any id of the dictionary."""
    own = {face.marker_id for face in CUBE.faces}
    square = np.array([(0, 0), (9, 0), (9, 9), (0, 9)], np.float64)
    found = markers_of(CUBE, [Marker(number, square) for number in range(50)])
    assert {each.face.marker_id for each in found} == own
    assert len(found) == len(own)


class OtherFaceFound(CellSearch):
    """Finds another face than the one that it has measured, as in a blurred picture."""

    def advance(self, run: CellRun) -> CellRun:
        run = super().advance(run)
        if not run.done:
            return run
        assert run.match is not None
        assert "back" not in run.match.alignment.correlations
        return replace(run, match=replace(run.match, found=("back",)))


def test_a_lone_face_that_the_pose_was_not_measured_on_proves_nothing() -> None:
    pose = held(0.25, 0.1, 0.2, at=(0.0, 0.0, 0.6))
    cells = OtherFaceFound(CUBE, PROJECTION)
    found, _ = find(drawn(pose, "front"), [at(pose, "front")], cells)
    assert found
    assert not any(each.certain for each in found)


def test_a_face_that_the_pose_turns_away_contradicts_where_it_is_read_near() -> None:
    """On a sheet, the back lies beside the faces that look like two of a cube."""
    pose = held()
    picture = drawn(pose, "front", "top")
    two = [at(pose, "front"), at(pose, "top")]
    assert any(each.certain for each in find(picture, two)[0])
    back = CUBE.face("back")
    for beside, contradicts in ((1.4, True), (8.0, False)):
        corners = two[0].corners + (beside * two[0].size, 0.0)
        found, _ = find(picture, [*two, Observation(back, corners)])
        assert any(each.certain for each in found) != contradicts


def test_a_lean_that_no_marker_proposed_is_compared_as_others_are() -> None:
    """The other lean of a face that the cells have found, and OpenCV has not."""
    pose = held()
    picture, poses = drawn(pose), poses_by(CellSearch(CUBE, PROJECTION))
    told = poses.compare_cells(picture, CornerPose(pose, (), 0.0, np.eye(6)), [], LIGHT)
    while isinstance(told, CellRun):
        told = poses.compare_cells(picture, CornerPose(pose, (), 0.0, np.eye(6)), [], LIGHT, told)
    (found,) = told.candidates
    assert found.certain
    assert off(found.camera_from_cube, pose)[0] < 0.5
