"""A cube file is read exactly or refused in one line."""

import contextlib
import dataclasses
import math

import numpy as np
import pytest
from hypothesis import given, strategies as st

from cubeling.tracking import CubeModel, TrackingError
from cubeling.tracking.cube.file import write_cube
from cubeling.tracking.cube.marker import marker_cells
from cubeling.tracking.cube.model import FACE_AXES, bundled_cubes, face_corners
from cubeling.tracking.geometry import se3

GOOD = """
dictionary = "DICT_4X4_50"
edge_mm = 60
marker_mm = 45
[[face]]
name = "front"
marker_id = 3
[[face]]
name = "top"
marker_id = 4
"""

names = st.sampled_from(sorted(FACE_AXES))


def refusal(tmp_path, text):
    path = tmp_path / "cube.toml"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(TrackingError) as caught:
        CubeModel.load(path)
    message = str(caught.value)
    assert "\n" not in message
    assert "cube.toml" in message
    return message


def test_the_bundled_cubes_carry_the_roles_they_are_made_for():
    assert bundled_cubes() == ("companion", "locomotion")
    roles = {face.name: face.role for face in CubeModel.load("locomotion").faces}
    assert (roles["front"], roles["left"], roles["right"], roles["back"]) == (
        "idle",
        "walk",
        "walk",
        "run",
    )
    companion = [face.role for face in CubeModel.load("companion").faces]
    assert sorted(companion) == ["idle", "idle", "kiss", "kiss", "shout", "shout"]


def test_no_two_bundled_markers_are_taken_for_one_another_and_none_for_itself_turned():
    """Six of sixteen bits apart, on one cube and between the two."""
    ids = [face.marker_id for name in bundled_cubes() for face in CubeModel.load(name).faces]
    assert len(set(ids)) == 12
    bits = {number: marker_cells("DICT_4X4_50", number)[1:-1, 1:-1] for number in ids}
    for one in ids:
        for other in ids:
            for turns in range(one == other, 4):
                assert np.sum(bits[one] != np.rot90(bits[other], turns)) >= 6


@given(name=names, roll=st.sampled_from([0, 90, 180, 270]))
def test_corners_run_clockwise_seen_from_outside_and_lie_on_the_face(name, roll):
    corners = face_corners(name, roll, 0.045, 0.06)
    right, up = (np.array(axis, float) for axis in FACE_AXES[name])
    normal = np.cross(right, up)
    np.testing.assert_allclose(corners @ normal, 0.03, atol=1e-15)
    winding = np.cross(corners[1] - corners[0], corners[2] - corners[1])
    np.testing.assert_allclose(winding, -normal * 0.045**2, atol=1e-15)


@given(roll=st.sampled_from([0, 90, 180, 270]))
def test_a_roll_turns_the_marker_clockwise(roll):
    corners = face_corners("front", roll, 2.0, 2.0)[:, :2]
    angle = math.radians(-roll)
    turn = np.array([[math.cos(angle), -math.sin(angle)], [math.sin(angle), math.cos(angle)]])
    upright = face_corners("front", 0, 2.0, 2.0)[:, :2]
    np.testing.assert_allclose(corners, upright @ turn.T, atol=1e-12)


@given(edge=st.floats(0.01, 1.0))
def test_a_scaled_cube_keeps_its_proportions(edge):
    cube = CubeModel.load("companion")
    scaled = cube.scale(edge)
    assert scaled.marker_size / scaled.edge == pytest.approx(cube.marker_size / cube.edge)
    for face, before in zip(scaled.faces, cube.faces, strict=True):
        fresh = face_corners(face.name, face.roll_deg, scaled.marker_size, scaled.edge)
        np.testing.assert_allclose(face.corners, fresh, atol=1e-15)
        np.testing.assert_array_equal(face.normal, before.normal)


@pytest.mark.parametrize("edge", [0.0, -0.06, 0.009, 1.1, math.nan, math.inf])
def test_a_cube_is_not_scaled_to_an_impossible_size(edge):
    with pytest.raises(TrackingError, match="10 to 1000 mm"):
        CubeModel.load("companion").scale(edge)


def test_a_file_with_some_faces_is_a_cube(tmp_path):
    path = tmp_path / "mine.toml"
    path.write_text(GOOD, encoding="utf-8")
    cube = CubeModel.load(path)
    assert (cube.name, cube.edge, cube.marker_size) == ("mine", 0.06, 0.045)
    assert [face.name for face in cube.faces] == ["front", "top"]
    with pytest.raises(KeyError):
        cube.face("back")


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("marker_id = 4", "marker_id = 3", "two have the marker_id 3"),
        ('"top"', '"front"', "two have the name 'front'"),
        ("marker_mm = 45", "marker_mm = 61", "does not fit its face"),
        ("marker_mm = 45", "marker_mm = 60", "does not fit its face"),
        ("edge_mm = 60", "edge_mm = nan", "edge_mm must be a number from 1 to 1000, not "),
        ("edge_mm = 60", "edge_mm = inf", "edge_mm must be a number from 1 to 1000, not "),
        ("edge_mm = 60", "edge_mm = -60", "edge_mm must be a number from 1 to 1000, not "),
        ("edge_mm = 60", 'edge_mm = "60"', "edge_mm must be a number from 1 to 1000, not "),
        ("edge_mm = 60", "edge_mm = true", "edge_mm must be a number from 1 to 1000, not "),
        ("edge_mm = 60", "", "edge_mm is missing; it must be a number from 1 to 1000"),
        (
            "marker_id = 4",
            "marker_id = 50",
            "face[1].marker_id must be a whole number from 0",
        ),
        (
            "marker_id = 4",
            "marker_id = -1",
            "face[1].marker_id must be a whole number from 0",
        ),
        (
            "marker_id = 4",
            "marker_id = 4.0",
            "a whole number from 0 to 49, not 4.0",
        ),
        ("marker_id = 4", "", "face[1].marker_id is missing; it must be a whole number"),
        (
            '"top"',
            '"lid"',
            "face[1].name must be one of front, right, ",
        ),
        ('"top"', '["top"]', "bottom, not ['top']"),
        (
            "marker_id = 4",
            "marker_id = 4\nroll_deg = 45",
            "must be 0, 90, 180 or 270, not 45",
        ),
        ("marker_id = 4", 'marker_id = 4\nicon = "fly"', "icon must be one of stand"),
        ("marker_id = 4", 'marker_id = 4\nrole = "a\\nb"', "one line of text"),
        (
            "DICT_4X4_50",
            "DICT_3X3_50",
            "must be one of OpenCV's, such as DICT_4X4_50, not",
        ),
        ("DICT_4X4_50", "Dictionary", "such as DICT_4X4_50, not"),
        ('"DICT_4X4_50"', "7", "dictionary must be a text, not 7"),
        ("[[face]]", "[[side]]", "side means nothing here; there are name, hint, dictionary"),
        ("edge_mm = 60", "edge_mm = 60\nedge_cm = 6", "edge_cm means nothing here"),
        (
            "marker_id = 4",
            "marker_id = 4\nroll = 90",
            "face[1].roll means nothing here; did you mean 'role'?",
        ),
        ("edge_mm", "edge mm", "not TOML"),
    ],
)
def test_a_bad_file_is_refused_in_one_line_that_says_what_to_change(tmp_path, old, new, words):
    assert words in refusal(tmp_path, GOOD.replace(old, new))


def test_faces_that_are_not_tables_are_refused(tmp_path):
    head = GOOD.split("[[face]]", maxsplit=1)[0]
    assert "face must be a list" in refusal(tmp_path, head + "face = 3")
    assert "at least one [[face]]" in refusal(tmp_path, head)
    assert "face must be tables, not 1" in refusal(tmp_path, head + "face = [1, 2]")


def test_a_missing_file_and_an_unknown_name_are_refused():
    with pytest.raises(TrackingError, match="no cube is called 'sphere': choose companion"):
        CubeModel.load("sphere")
    with pytest.raises(TrackingError, match=r"cannot read the cube 'nowhere\.toml'"):
        CubeModel.load("nowhere.toml")


scalars = st.one_of(
    st.none(),
    st.booleans(),
    st.integers(),
    st.floats(),
    st.text("ab\n°", max_size=3),
    st.lists(st.integers()),
)
tables = st.dictionaries(
    st.sampled_from(["name", "marker_id", "roll_deg", "role", "icon"]),
    st.one_of(scalars, names, st.integers(0, 49)),
)
documents = st.dictionaries(
    st.sampled_from(["dictionary", "edge_mm", "marker_mm", "face", "name", "hint"]),
    st.one_of(
        scalars,
        st.floats(1, 1000),
        st.just("DICT_4X4_50"),
        st.lists(st.one_of(tables, scalars), max_size=6),
    ),
)


@given(documents)
def test_any_file_gives_a_printable_cube_or_a_tracking_error(document):
    with contextlib.suppress(TrackingError):
        assert_printable(CubeModel.from_document(document, "cube.toml", "any"))


def assert_printable(cube):
    assert 0 < cube.marker_size < cube.edge
    ids = [face.marker_id for face in cube.faces]
    assert len(set(ids)) == len(ids) > 0
    for face in cube.faces:
        assert np.isfinite(face.corners).all()


def folded(cube, turn, shift):
    """The cube with each face a little off: turned about its centre and shifted."""
    faces = []
    for number, face in enumerate(cube.faces):
        centre = face.corners.mean(axis=0)
        turned = (face.corners - centre) @ se3.rotation(turn * (1 + number)).T
        faces.append(dataclasses.replace(face, corners=turned + centre + shift))
    return dataclasses.replace(cube, faces=tuple(faces))


@given(st.tuples(*[st.floats(-0.004, 0.004)] * 3), st.tuples(*[st.floats(-0.001, 0.001)] * 3))
def test_a_measured_cube_is_read_back_to_a_ten_thousandth_of_a_millimetre(
    tmp_path_factory, turn, shift
):
    cube = folded(CubeModel.load("companion"), np.array(turn), np.array(shift))
    path = tmp_path_factory.getbasetemp() / "measured.toml"
    write_cube(cube, path)
    again = CubeModel.load(path)
    for old, new in zip(cube.faces, again.faces, strict=True):
        np.testing.assert_allclose(new.corners, old.corners, atol=1e-7)
        assert dataclasses.replace(new, corners=old.corners) == old
        edges = new.corners[1:3] - new.corners[0]
        assert np.abs(edges @ new.normal).max() < 2e-7
        assert np.linalg.norm(new.normal) == pytest.approx(1)
    assert (again.name, again.hint, again.dictionary) == (cube.name, cube.hint, cube.dictionary)
    assert (again.edge, again.marker_size) == (cube.edge, cube.marker_size)


def test_a_perfect_cube_is_written_without_measured_corners_and_read_back_to_the_last_bit(tmp_path):
    path = tmp_path / "cube.toml"
    cube = CubeModel.load("locomotion")
    write_cube(cube, path)
    assert "corners_mm" not in path.read_text(encoding="utf-8")
    for old, new in zip(cube.faces, CubeModel.load(path).faces, strict=True):
        np.testing.assert_array_equal(new.corners, old.corners)
        right, up = FACE_AXES[new.name]
        np.testing.assert_array_equal(new.normal, np.cross(right, up))


SQUARE = "[[-22.5, 22.5, 30], [22.5, 22.5, 30], [22.5, -22.5, 30], [-22.5, -22.5, 30]]"


@pytest.mark.parametrize(
    ("corners", "words"),
    [
        ("[[1, 2, 3]]", "4 corners of 3 numbers"),
        ('"none"', "4 corners of 3 numbers"),
        (SQUARE.replace("30]]", "nan]]"), "4 corners of 3 numbers"),
        (SQUARE.replace("22.5", "21.5"), "no square of 45 mm"),
        (SQUARE.replace("[[-22.5, 22.5, 30]", "[[-22.5, 22.5, 32]"), "no square of 45 mm"),
        (SQUARE.replace("30", "-30"), "60.0 mm from where the marker should be"),
    ],
)
def test_measured_corners_that_are_not_the_marker_are_refused(tmp_path, corners, words):
    text = GOOD.replace("marker_id = 3", f"marker_id = 3\ncorners_mm = {corners}")
    assert words in refusal(tmp_path, text)


def test_a_cube_is_written_to_a_toml_file_or_not_at_all(tmp_path):
    cube = CubeModel.load("companion")
    with pytest.raises(TrackingError, match=r"\.toml file, not to"):
        write_cube(cube, tmp_path / "cube.yaml")
    with pytest.raises(TrackingError, match=r"cannot write .*cube\.toml"):
        write_cube(cube, tmp_path / "none" / "cube.toml")
    assert list(tmp_path.iterdir()) == []
