"""The sheet is told from the cube by markers of several sides that lie in one plane."""

import numpy as np
from numpy.typing import NDArray

from cubeling.tracking.cube.faces import FacePlanes
from cubeling.tracking.cube.model import CubeModel
from cubeling.tracking.cube.printing.unfolding import Unfolding
from cubeling.tracking.detection.flat_sheet import lie_flat
from cubeling.tracking.detection.markers import Observation
from cubeling.tracking.geometry import se3
from cubeling.tracking.geometry.projection import Projection
from tests.tracking.cube.folding import cube_from_face
from tests.tracking.drawn import CAMERA

Array = NDArray[np.float64]

CUBE = CubeModel.load("companion")
PROJECTION = Projection(CAMERA)
ERROR_PX = 0.3


def some_pose(rng: np.random.Generator, distance: tuple[float, float]) -> Array:
    turn = rng.normal(size=3)
    turn *= rng.uniform(0, np.pi) / np.linalg.norm(turn)
    return se3.pose(se3.rotation(turn), np.array([0.0, 0.0, rng.uniform(*distance)]))


def seen(corners: Array, rng: np.random.Generator) -> Array:
    pixels = PROJECTION.project(corners)
    return pixels + rng.normal(0, ERROR_PX, pixels.shape)


def folded(rng: np.random.Generator) -> list[Observation]:
    """The markers of the folded cube that face the camera."""
    pose = some_pose(rng, (0.1, 0.8))
    faces = [CUBE.faces[number] for number in FacePlanes(CUBE).faces_towards(pose, 0.05)]
    return [
        Observation(face, seen(face.corners @ pose[:3, :3].T + pose[:3, 3], rng)) for face in faces
    ]


def unfolded(rng: np.random.Generator, least: int = 3, angle: float = 0.0) -> list[Observation]:
    """Some markers of the sheet, with every fold bent by an angle."""
    net = Unfolding(CUBE.edge)
    pose = some_pose(rng, (0.35, 0.8))
    pose[:3, :3] = se3.rotation(rng.uniform(-0.7, 0.7, 3)) @ np.diag([1.0, -1.0, -1.0])
    names = rng.permutation([face.name for face in CUBE.faces])[: rng.integers(least, 7)]
    found = []
    for name in names:
        whole, flat = (cube_from_face(net, str(name), each) for each in (np.pi / 2, angle))
        corners = CUBE.face(str(name)).corners
        on_sheet = np.c_[corners, np.ones(4)] @ (pose @ flat @ np.linalg.inv(whole)).T
        found.append(Observation(CUBE.face(str(name)), seen(on_sheet[:, :3], rng)))
    return found


def test_a_folded_cube_never_lies_flat() -> None:
    rng = np.random.default_rng(1)
    shown = [folded(rng) for _ in range(300)]
    assert sum(len(each) >= 3 for each in shown) > 100
    assert not any(map(lie_flat, shown))


def test_three_markers_of_the_sheet_are_enough() -> None:
    rng = np.random.default_rng(2)
    assert all(lie_flat(unfolded(rng)) for _ in range(100))


def test_paper_that_bends_a_little_in_the_hand_is_a_sheet_still() -> None:
    rng = np.random.default_rng(5)
    assert all(lie_flat(unfolded(rng, least=6, angle=0.1)) for _ in range(100))


def test_two_markers_tell_nothing() -> None:
    """Two sides of a far cube that lean alike look like two squares of a sheet."""
    rng = np.random.default_rng(3)
    assert not lie_flat(unfolded(rng)[:2])
    assert not lie_flat([])


def test_a_marker_that_is_read_twice_counts_once() -> None:
    one, other, *_ = unfolded(np.random.default_rng(4))
    moved = Observation(one.face, one.corners + 2.0)
    assert not lie_flat([one, moved, other])
