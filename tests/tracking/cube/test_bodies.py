"""Files of boxes and other bodies: what they describe, and what is refused."""

from pathlib import Path

import numpy as np
import pytest

from cubeling.tracking import CubeModel, TrackingError
from cubeling.tracking.cube.file import write_cube
from cubeling.tracking.cube.printing.sheet import write_sheet
from cubeling.tracking.cube.sides import SideDirections, box_sides

BOX = """
dictionary = "DICT_4X4_50"
size_mm = [90, 40, 60]
marker_mm = 30
[[face]]
name = "front"
role = "idle"
[[face.marker]]
marker_id = 1
at_mm = [-20, 0]
[[face.marker]]
marker_id = 2
at_mm = [20, 0]
roll_deg = 90
[[face]]
name = "top"
marker_id = 3
"""

PYRAMID = """
dictionary = "DICT_4X4_50"
marker_mm = 20
[[face]]
name = "base"
center_mm = [0, -10, 0]
normal = [0, -1, 0]
outline_mm = [[-30, -30], [30, -30], [30, 30], [-30, 30]]
[[face]]
name = "slope"
center_mm = [0, 5, 15]
normal = [0, 1, 1]
marker_id = 7
[[face]]
name = "back"
center_mm = [0, 5, -15]
normal = [0, 1, -1]
up = [0, 1, 1]
marker_id = 8
"""


def load(tmp_path, text):
    path = tmp_path / "body.toml"
    path.write_text(text, encoding="utf-8")
    return CubeModel.load(path)


def test_a_box_carries_several_markers_on_a_side(tmp_path):
    box = load(tmp_path, BOX)
    assert [(face.name, face.side) for face in box.faces] == [
        ("front/1", "front"),
        ("front/2", "front"),
        ("top", "top"),
    ]
    assert [face.role for face in box.faces] == ["idle", "idle", ""]
    left, right, top = (face.corners * 1000 for face in box.faces)
    np.testing.assert_allclose(left, [[-35, 15, 30], [-5, 15, 30], [-5, -15, 30], [-35, -15, 30]])
    np.testing.assert_allclose(right[0], [35, 15, 30])  # turned clockwise: its top left is right
    np.testing.assert_allclose(top.mean(axis=0), [0, 20, 0])
    assert np.ptp(box.vertices * 1000, axis=0).tolist() == pytest.approx([90, 40, 60])
    assert box.paper * 1000 == pytest.approx(40)


def test_the_white_around_a_marker_may_have_corners_beyond_its_side(tmp_path):
    cube, box = CubeModel.load("companion"), load(tmp_path, BOX)
    assert (cube.white, box.white) == (cube.edge, pytest.approx(box.paper))
    body = CubeModel.load(Path(__file__).parents[1] / "dodecahedron.toml")
    cell = body.marker_size / 8
    assert (body.paper - body.marker_size) / 2 < 0.6 * cell
    assert (body.white - body.marker_size) / 2 == pytest.approx(1.5 * cell)


def test_a_side_is_placed_by_centre_normal_and_up(tmp_path):
    body = load(tmp_path, PYRAMID)
    assert [face.name for face in body.faces] == ["slope", "back"]
    half = np.sqrt(0.5)
    for face, inward in zip(body.faces, (1, -1), strict=True):
        np.testing.assert_allclose(face.normal, [0, half, inward * half])
        assert np.linalg.norm(face.corners[1] - face.corners[0]) == pytest.approx(0.02)
    assert body.faces[0].corners[0, 0] < 0  # the left of the marker, seen from outside
    assert body.faces[1].corners[0, 0] > 0


@pytest.mark.parametrize("text", [BOX, PYRAMID], ids=["box", "pyramid"])
def test_a_body_is_written_and_read_back(tmp_path, text):
    body = load(tmp_path, text)
    path = tmp_path / "again.toml"
    write_cube(body, path)
    assert "corners_mm" not in path.read_text(encoding="utf-8")
    again = CubeModel.load(path)
    assert [face.name for face in again.faces] == [face.name for face in body.faces]
    for new, old in zip(again.faces, body.faces, strict=True):
        np.testing.assert_allclose(new.corners, old.corners, atol=1e-7)
        assert (new.role, new.roll_deg) == (old.role, old.roll_deg)
    for side, before in zip(again.sides, body.sides, strict=True):
        np.testing.assert_allclose(side.corners, before.corners, atol=1e-7)


def test_the_bodies_of_the_guide_are_those_that_it_describes(tmp_path):
    guide = (Path(__file__).parents[3] / "docs" / "your-own-cube.md").read_text(encoding="utf-8")
    cube, box, wedge = (
        load(tmp_path, text.partition("```")[0]) for text in guide.split("```toml")[1:]
    )
    assert (cube.body, len(box.body), len(wedge.body)) == ((), 6, 2)
    assert [face.name for face in box.faces] == ["front/1", "front/2", "top"]
    assert [face.name for face in wedge.faces] == ["slope"]


def test_a_body_that_is_scaled_keeps_its_proportions(tmp_path):
    body = load(tmp_path, BOX)
    larger = body.scale(2 * body.edge)
    np.testing.assert_allclose(larger.vertices, 2 * body.vertices)
    assert larger.paper == pytest.approx(2 * body.paper)
    for face in larger.faces:
        np.testing.assert_allclose(larger.designed_corners(face), face.corners)


def test_a_body_has_no_sheet(tmp_path):
    with pytest.raises(TrackingError, match="'body' has no sheet"):
        write_sheet(load(tmp_path, BOX), tmp_path / "sheet.pdf")


def test_a_cube_with_a_marker_off_the_middle_is_a_body(tmp_path):
    cube = load(tmp_path, BOX.replace("size_mm = [90, 40, 60]", "edge_mm = 90"))
    assert cube.edge == pytest.approx(0.09)
    assert len(cube.body) == 6


@pytest.mark.parametrize(
    ("text", "old", "new", "words"),
    [
        (BOX, "size_mm", "edge_mm = 60\nsize_mm", "size_mm: a cube has edge_mm, a box size_mm"),
        (BOX, "[90, 40, 60]", "[90, 40]", "size_mm must be a list of 3 numbers"),
        (BOX, "at_mm = [20, 0]", "at_mm = [5, 0]", "does not fit its face"),
        (BOX, "at_mm = [20, 0]", "at_mm = [40, 0]", "does not fit its face"),
        (BOX, "marker_id = 2", "marker_id = 1", "two have the marker_id 1"),
        (BOX, 'name = "top"', 'name = "lid"', "name must be one of front, right"),
        (BOX, 'name = "top"', 'name = "top"\nnormal = [0, 1, 0]', "normal means nothing here"),
        (PYRAMID, "normal = [0, 1, 1]", "normal = [0, 0, 0]", "normal: it has no direction"),
        (PYRAMID, "normal = [0, 1, 1]", "normal = [0, -1, -1]", "away from the origin"),
        (PYRAMID, "up = [0, 1, 1]", "up = [0, 1, -1]", "up: it points where the normal does"),
        (
            PYRAMID,
            "center_mm = [0, 5, 15]",
            "",
            "center_mm is missing; it must be a list",
        ),
        (PYRAMID, "[30, 30], [-30, 30]", "[-30, 30], [30, 30]", "it must be convex"),
        (PYRAMID, "[[-30, -30], [30, -30],", "[[-30], [30],", "at least 3 corners of 2 numbers"),
        (PYRAMID, "-30], [30, 30]", "nan], [30, 30]", "at least 3 corners of 2 numbers"),
        (PYRAMID, '"slope"', '"base"', "two have the name 'base'"),
        (PYRAMID, '"slope"', '"a/b"', "must be a name without /"),
        (
            PYRAMID,
            "center_mm = [0, 5, -15]\nnormal = [0, 1, -1]\nup = [0, 1, 1]",
            "center_mm = [40, 5, 15]\nnormal = [0, 1, 1]",
            "'slope' and 'back' lie in one plane",
        ),
    ],
)
def test_a_mistake_is_refused_with_the_key(tmp_path, text, old, new, words):
    assert old in text
    with pytest.raises(TrackingError) as caught:
        load(tmp_path, text.replace(old, new, 1))
    assert words in str(caught.value)
    assert "body.toml" in str(caught.value)
    assert "\n" not in str(caught.value)


def test_a_body_stands_on_what_is_opposite_to_the_side_that_is_up(tmp_path):
    box = SideDirections(box_sides(0.09, 0.04, 0.06))
    assert dict(zip(box.normals, box.depths.tolist(), strict=True)) == pytest.approx(
        {"front": 0.03, "back": 0.03, "right": 0.045, "left": 0.045, "top": 0.02, "bottom": 0.02}
    )
    pyramid = SideDirections(load(tmp_path, PYRAMID).sides)
    assert pyramid.normals["on base"].tolist() == [0, 1, 0]
    assert pyramid.depths[list(pyramid.normals).index("on base")] == pytest.approx(0.01)
