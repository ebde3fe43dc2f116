"""Markers are read where the pose says that they are, and nowhere else."""

import cv2
import numpy as np
import pytest
from numpy.typing import NDArray

from cubeling.tracking.cube.faces import FacePlanes
from cubeling.tracking.cube.model import CubeModel
from cubeling.tracking.detection.marker_check import CellReader, CellReading
from cubeling.tracking.geometry import se3
from cubeling.tracking.geometry.image_region import Patch
from cubeling.tracking.geometry.projection import Projection
from cubeling.tracking.refinement.edge_search import MIN_READ_AGREEMENT
from cubeling.tracking.synthetic import open_synthetic
from tests.tracking.drawn import CAMERA, held, photograph, scene

Array = NDArray[np.float64]
Picture = NDArray[np.uint8]

CUBE, OTHER = CubeModel.load("locomotion"), CubeModel.load("companion")
FACES = FacePlanes(CUBE)
READER = CellReader(CUBE, Projection(CAMERA))
CELL = CUBE.marker_size / 6
VIEWS = [held(), held(0.8, -0.5, 0.4), held(0.4, 2.2, -0.3), held(-0.6, 0.7, 1.0)]


def square_enough(pose: Array) -> set[str]:
    """Faces whose cells are wide enough to be read surely."""
    return {FACES.names[number] for number in FACES.faces_towards(pose, 0.35)}


def read(picture: Picture, pose: Array, reader: CellReader = READER) -> CellReading:
    return reader.read(Patch.crop(picture), pose)


@pytest.fixture(scope="module", params=range(len(VIEWS)))
def seen(request: pytest.FixtureRequest) -> tuple[Picture, Array]:
    """A picture and the pose that it shows."""
    return photograph(scene((CUBE, VIEWS[request.param]))), VIEWS[request.param]


def test_the_cells_agree_at_the_true_pose(seen: tuple[Picture, Array]) -> None:
    picture, pose = seen
    reading = read(picture, pose)
    faces = square_enough(pose)
    assert len(faces) >= 2
    assert min(reading.agreement[name] for name in faces) >= 0.97
    assert reading.best == 1.0


def test_the_cells_agree_through_a_distorting_lens_too() -> None:
    source = open_synthetic("static?frames=1")
    assert source.intrinsics is not None
    reader = CellReader(source.cube, Projection(source.intrinsics))
    reading = read(source.frame(0).image, source.truth(0), reader)
    for name in square_enough(source.truth(0)):
        assert reading.agreement[name] >= 0.97


def test_the_cells_disagree_one_cell_off(seen: tuple[Picture, Array]) -> None:
    picture, pose = seen
    shares = []
    for name in square_enough(pose):
        face = CUBE.face(name)
        right, down = (face.corners[to] - face.corners[0] for to in (1, 3))
        for way in (right, down, -right, -down):
            shift = pose[:3, :3] @ way / CUBE.marker_size * CELL
            shifted = se3.apply_delta(pose, np.append(shift, np.zeros(3)))
            shares.append(read(picture, shifted).agreement[name])
    assert max(shares) < 0.8
    assert np.mean(shares) < 0.65


def test_another_cube_at_the_pose_is_not_read(seen: tuple[Picture, Array]) -> None:
    _, pose = seen
    reading = read(photograph(scene((OTHER, pose))), pose)
    assert reading.best < 0.9
    assert reading.best < MIN_READ_AGREEMENT
    # Half of the cells are alike on all markers: what tells them apart is which marker it is.
    alike = {name for name in square_enough(pose) if reading.agreement[name] > 0.7}
    assert reading.others >= alike


def half_covered(picture: Picture, pose: Array, name: str, side: int, grey: int) -> Picture:
    """Lay something flat over the half of a marker that is nearest to one of its sides."""
    corners = np.roll(CUBE.face(name).corners, -side, axis=0)
    middles = [(corners[1] + corners[2]) / 2, (corners[0] + corners[3]) / 2]
    points = np.array([corners[0], corners[1], *middles]) @ pose[:3, :3].T + pose[:3, 3]
    pixels = np.rint(Projection(CAMERA).project(points)).astype(np.int32)
    covered = picture.copy()
    cv2.fillConvexPoly(covered, pixels, (grey, grey, grey))
    return covered


def test_a_half_covered_marker_is_not_read(seen: tuple[Picture, Array]) -> None:
    """Covered cells agree by chance: most of a marker is black, and a flat cover counts as that."""
    picture, pose = seen
    shares = []
    for name in square_enough(pose):
        for side in range(4):
            for grey in (60, 90, 120, 150, 180, 210):
                reading = read(half_covered(picture, pose, name, side, grey), pose)
                assert reading.agreement.get(name, 0.0) < MIN_READ_AGREEMENT
                assert name not in reading.others
                shares.append(reading.agreement[name])
    assert max(shares) < 0.93
    assert 0.5 < np.median(shares) < 0.8


def test_without_contrast_nothing_is_read(seen: tuple[Picture, Array]) -> None:
    _, pose = seen
    flat = read(np.full((480, 640, 3), 120, np.uint8), pose)
    assert set(flat.agreement.values()) == {0.0}
    assert flat.best == 0.0
    black = photograph(0.2 * np.ones((480, 640), np.float32), noise=0.5)
    assert read(black, pose).best == 0.0


def test_an_inverted_marker_is_not_read(seen: tuple[Picture, Array]) -> None:
    picture, pose = seen
    assert read(255 - picture, pose).best == 0.0


def test_no_face_is_read_outside_the_image_or_behind_the_camera() -> None:
    picture = np.zeros((480, 640, 3), np.uint8)
    for place in ((3.0, 0, 0.4), (0, 0, -0.4)):
        reading = read(picture, held(at=place))
        assert reading.best == 0.0
        assert reading.best < MIN_READ_AGREEMENT


def test_a_face_at_the_border_is_read_by_its_visible_part() -> None:
    for x, there in ((-0.19, True), (-0.205, False)):
        pose = held(0.2, 0.0, 0.0, at=(x, 0, 0.4))
        points = CUBE.face("front").corners @ pose[:3, :3].T + pose[:3, 3]
        outside = Projection(CAMERA).project(points)[:, 0] < 0
        assert outside.sum() == 2
        reading = read(photograph(scene((CUBE, pose))), pose)
        assert reading.agreement.get("front") == (1.0 if there else None)
