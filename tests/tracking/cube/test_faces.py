"""Which faces face the camera, their frames, and the other pose that a single one may have."""

import numpy as np
import pytest
from hypothesis import assume, given, strategies as st
from numpy.typing import NDArray

from cubeling.tracking.cube.faces import FacePlanes, face_frame
from cubeling.tracking.cube.model import FACE_AXES, CubeModel, Face, bundled_cubes, face_corners
from cubeling.tracking.geometry import se3
from cubeling.tracking.synthetic.folding import fold_cube

Array = NDArray[np.float64]

CUBES = [CubeModel.load(name) for name in bundled_cubes()]
CUBE = CubeModel.load("locomotion")
FACES = FacePlanes(CUBE)

turns = st.tuples(*[st.floats(-3.1, 3.1)] * 3)
places = st.tuples(st.floats(-0.4, 0.4), st.floats(-0.3, 0.3), st.floats(0.2, 1.5))


def posed(turn: tuple[float, ...], place: tuple[float, ...]) -> Array:
    return se3.pose(se3.rotation(np.array(turn)), np.array(place))


@given(turns, places, st.integers(0, 5))
def test_a_pose_mirrored_twice_is_the_same_pose(
    turn: tuple[float, ...], place: tuple[float, ...], face: int
) -> None:
    pose = posed(turn, place)
    # Seen from behind there is no line of sight to mirror on.
    assume(FACES.cosines(pose)[face] > -0.99)
    assert np.allclose(FACES.mirror(FACES.mirror(pose, face), face), pose, atol=1e-8)


@given(turns, places, st.integers(0, 5))
def test_a_mirrored_face_keeps_its_centre_and_tilts_as_far_to_the_other_side(
    turn: tuple[float, ...], place: tuple[float, ...], face: int
) -> None:
    pose = posed(turn, place)
    cosine = FACES.cosines(pose)[face]
    assume(cosine > 0.05)
    other = FACES.mirror(pose, face)
    centres = [each[:3, :3] @ FACES.centres[face] + each[:3, 3] for each in (pose, other)]
    assert np.allclose(centres[0], centres[1], atol=1e-12)
    assert FACES.cosines(other)[face] == pytest.approx(cosine, abs=1e-9)
    # Twice the lean apart, but for the roundness of arccos at 1.
    lean = np.arccos(min(cosine, 1.0))
    assert se3.angle_between(pose, other) == pytest.approx(2 * lean, abs=1e-6)
    normals = [each[:3, :3] @ FACES.normals[face] for each in (pose, other)]
    sight = -centres[0] / np.linalg.norm(centres[0])
    assert np.allclose(normals[0] + normals[1], 2 * cosine * sight, atol=1e-9)


@pytest.mark.parametrize("cube", CUBES, ids=lambda cube: cube.name)
def test_normals_of_the_bundled_cubes_are_those_of_their_axes(cube: CubeModel) -> None:
    faces = FacePlanes(cube)
    for name, normal, centre in zip(faces.names, faces.normals, faces.centres, strict=True):
        axis = np.cross(*FACE_AXES[name])
        assert np.allclose(normal, axis, atol=1e-12)
        assert np.allclose(centre, axis * cube.edge / 2, atol=1e-12)
        assert np.allclose(normal, cube.face(name).normal, atol=1e-12)


@pytest.mark.parametrize("roll", [0, 90, 180, 270])
@pytest.mark.parametrize("name", FACE_AXES)
def test_the_frame_of_a_face_lies_as_its_marker_does(name: str, roll: int) -> None:
    face = Face(name, 3, face_corners(name, roll, 0.045, 0.06), roll_deg=roll)
    frame = face_frame(face)
    assert np.allclose(frame[:3, :3].T @ frame[:3, :3], np.eye(3), atol=1e-12)
    assert np.linalg.det(frame[:3, :3]) == pytest.approx(1)
    # In its own frame the marker is a square, from top-left round by the right, y down.
    corners = (face.corners - frame[:3, 3]) @ frame[:3, :3]
    square = np.array([(-1, -1, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0)]) * 0.0225
    assert np.allclose(corners, square, atol=1e-12)
    assert np.allclose(frame[:3, 2], -face.normal, atol=1e-12)


def test_a_face_that_was_folded_askew_still_has_a_right_angled_frame() -> None:
    askew = fold_cube(CUBE, 2.0, 4)
    for face, square in zip(askew.faces, CUBE.faces, strict=True):
        frame = face_frame(face)
        assert np.allclose(frame[:3, :3].T @ frame[:3, :3], np.eye(3), atol=1e-12)
        lean = np.arccos(np.clip(face.normal @ square.normal, -1, 1))
        assert np.deg2rad(0.01) < lean < np.deg2rad(4)
        assert np.allclose(frame[:3, 3], face.corners.mean(axis=0))


def test_only_faces_towards_the_camera_face_it() -> None:
    """Half a metre away and square on: one face, and its neighbours seen from behind."""
    pose = se3.pose(np.diag([1.0, -1.0, -1.0]), np.array([0, 0, 0.5]))
    assert [FACES.names[number] for number in FACES.faces_towards(pose, 0.1)] == ["front"]
    assert FACES.cosines(pose)[FACES.names.index("front")] == pytest.approx(1)
    assert FACES.cosines(pose)[FACES.names.index("back")] == pytest.approx(-1)
    # Aside in the picture the same attitude shows the inner side too.
    aside = se3.pose(pose[:3, :3], np.array([0.4, 0, 0.5]))
    assert {FACES.names[number] for number in FACES.faces_towards(aside, 0.1)} == {"front", "left"}
