"""The printed page: measured, detected and folded as paper would be."""

from dataclasses import replace

import cv2
import numpy as np
import pypdfium2
import pytest

from cubeling.tracking import CubeModel, TrackingError, icon_mask, icon_paths, write_sheet
from cubeling.tracking.cube.icons import ICON_COLOURS, icons, signed_area
from cubeling.tracking.cube.marker import marker_cells, marker_loops
from cubeling.tracking.cube.model import aruco_dictionary, bundled_cubes
from cubeling.tracking.cube.printing.layout import PAPER_SIZES_MM, SheetLayout, largest_edge_mm
from cubeling.tracking.cube.printing.unfolding import Unfolding
from tests.examples import some
from tests.tracking.cube.folding import cube_from_face

DPI = 254
PIXELS_PER_MM = DPI / 25.4


def rasterised(path, dpi=DPI):
    document = pypdfium2.PdfDocument(path)
    try:
        return document[0].render(scale=dpi / 72, grayscale=True).to_numpy().copy()
    finally:
        document.close()


def detected(image, dictionary, pixels_per_mm=PIXELS_PER_MM):
    """Corners of all markers [mm from the top left of the page], by their number."""
    parameters = cv2.aruco.DetectorParameters()
    parameters.cornerRefinementMethod = cv2.aruco.CORNER_REFINE_SUBPIX
    detector = cv2.aruco.ArucoDetector(aruco_dictionary(dictionary), parameters)
    corners, ids, _ = detector.detectMarkers(image)
    assert ids is not None
    assert len(set(ids.ravel())) == len(ids)
    return {
        int(number): (quad[0] + 0.5) / pixels_per_mm
        for number, quad in zip(ids.ravel(), corners, strict=True)
    }


@pytest.fixture(scope="module")
def sheets(tmp_path_factory):
    """The sheet of each bundled cube."""
    paths = {name: tmp_path_factory.mktemp("sheet") / f"{name}.pdf" for name in bundled_cubes()}
    for name, path in paths.items():
        write_sheet(CubeModel.load(name), path)
    return paths


@pytest.fixture(scope="module", params=bundled_cubes())
def printed(request, sheets):
    cube, path = CubeModel.load(request.param), sheets[request.param]
    return cube, path, detected(rasterised(path), cube.dictionary)


def test_all_six_markers_are_found_at_the_right_size(printed):
    cube, _, corners = printed
    assert set(corners) == {face.marker_id for face in cube.faces}
    for quad in corners.values():
        sides = np.linalg.norm(np.roll(quad, -1, axis=0) - quad, axis=1)
        np.testing.assert_allclose(sides, cube.marker_size * 1000, atol=0.1)


def test_the_detected_page_folds_to_the_model_within_a_tenth_of_a_millimetre(printed):
    """Place and orientation at once: paper corners, folded as the net says, are the model's."""
    cube, _, corners = printed
    net = Unfolding(cube.edge)
    middle = corners[cube.face("front").marker_id].mean(axis=0)
    for face in cube.faces:
        paper = (corners[face.marker_id] - middle) * (0.001, -0.001)
        local = np.column_stack([paper - net.centre(face.name), np.zeros(4), np.ones(4)])
        folded = (local @ cube_from_face(net, face.name).T)[:, :3]
        assert np.linalg.norm(folded - face.corners, axis=1).max() < 1e-4


def test_the_ruler_is_100_mm_long(printed):
    dpi = 508
    _, path, _ = printed
    longest, dark = 0, rasterised(path, dpi) < 128
    for row in dark[dark.sum(axis=1) > 95 / 25.4 * dpi]:
        borders = np.flatnonzero(np.diff(row.astype(np.int8), prepend=0, append=0))
        longest = max(longest, int(np.max(borders[1::2] - borders[::2], initial=0)))
    # No other line is longer than an edge; its round ends add its own thickness, 0.25 mm.
    assert longest / dpi * 25.4 == pytest.approx(100.25, abs=0.1)


def test_the_page_says_how_to_print_it(printed):
    cube, path, _ = printed
    document = pypdfium2.PdfDocument(path)
    words = document[0].get_textpage().get_text_range()
    document.close()
    assert "must be 100 mm: print at 100 %, no fit-to-page" in words
    assert f"The {cube.name} cube" in words
    for step in ("1. Cut", "2. Fold", "3. Glue"):
        assert step in words
    for face in cube.faces:
        assert face.name in words
        assert face.role in words
    assert b"/PrintScaling /None" in path.read_bytes()


def test_every_side_of_a_face_has_its_icon_upright(sheets):
    """A child finds it however the cube lies, four fifths of the margin high."""
    cube = CubeModel.load("companion")
    document = pypdfium2.PdfDocument(sheets["companion"])
    blue, green, red = cv2.split(document[0].render(scale=DPI / 72).to_numpy())
    document.close()
    highest, least = cv2.max(cv2.max(blue, green), red), cv2.min(cv2.min(blue, green), red)
    coloured = highest - least > 60
    sheet = SheetLayout(cube, "a4")
    half, margin = cube.edge * 500, (cube.edge - cube.marker_size) * 500
    for face in cube.faces:
        x, y = sheet.place(sheet.net.centre(face.name)) * PIXELS_PER_MM
        side = round(half * PIXELS_PER_MM)
        square = coloured[round(y) - side : round(y) + side, round(x) - side : round(x) + side]
        icon = icon_mask(face.icon, round(0.8 * margin * PIXELS_PER_MM)) > 127
        foot, left = 2 * side - round(0.04 * margin * PIXELS_PER_MM), side - len(icon) // 2
        for quarter in range(4):
            turned = np.rot90(square, quarter)
            drawn = turned[foot - len(icon) : foot, left : left + len(icon)]
            assert (drawn != icon).mean() < 0.1, (face.name, quarter)


def test_captions_move_no_marker_corner_even_for_a_camera_far_away(sheets, tmp_path):
    cube = CubeModel.load("locomotion")
    bare = replace(cube, faces=tuple(replace(face, icon="", role="") for face in cube.faces))
    write_sheet(bare, tmp_path / "bare.pdf")
    far = {}
    for name, path in (("captions", sheets["locomotion"]), ("bare", tmp_path / "bare.pdf")):
        small = cv2.resize(
            rasterised(path), None, fx=0.1, fy=0.1, interpolation=cv2.INTER_AREA
        )  # a pixel is a millimetre: 0.9 m from a common webcam
        far[name] = detected(cv2.GaussianBlur(small, (0, 0), 0.7), cube.dictionary, 1.0)
    assert len(far["captions"]) == 6
    for number, corners in far["captions"].items():
        np.testing.assert_allclose(corners, far["bare"][number], atol=0.02)


@pytest.mark.parametrize(("edge_mm", "paper"), some([(64, "letter"), (30, "a4"), (95, "A3")]))
def test_another_edge_scales_the_markers_with_it(tmp_path, edge_mm, paper):
    cube = CubeModel.load("companion")
    path = tmp_path / "cube.pdf"
    write_sheet(cube, path, edge_mm=edge_mm, paper=paper)
    corners = detected(rasterised(path), cube.dictionary)
    assert len(corners) == 6
    for quad in corners.values():
        assert np.linalg.norm(quad[1] - quad[0]) == pytest.approx(edge_mm * 0.75, abs=0.1)
    document = pypdfium2.PdfDocument(path)
    width, height = document[0].get_size()
    document.close()
    assert (width * 25.4 / 72, height * 25.4 / 72) == pytest.approx(
        PAPER_SIZES_MM[paper.lower()], abs=0.01
    )


def test_turned_markers_and_missing_faces_are_drawn_as_the_file_says(tmp_path):
    cube = CubeModel.from_document(
        {
            "dictionary": "DICT_APRILTAG_36h11",
            "edge_mm": 50,
            "marker_mm": 40,
            "face": [
                {"name": "front", "marker_id": 0},
                {"name": "top", "marker_id": 7, "roll_deg": 90},
                {"name": "back", "marker_id": 9, "roll_deg": 180},
            ],
        },
        "mine.toml",
        "mine",
    )
    write_sheet(cube, tmp_path / "cube.pdf")
    corners = detected(rasterised(tmp_path / "cube.pdf"), cube.dictionary)
    assert set(corners) == {0, 7, 9}
    upright, quarter, half = (corners[number][1] - corners[number][0] for number in (0, 7, 9))
    np.testing.assert_allclose(upright, (40, 0), atol=0.1)
    np.testing.assert_allclose(quarter, (0, 40), atol=0.1)
    np.testing.assert_allclose(half, (-40, 0), atol=0.1)


def test_the_same_cube_gives_the_same_bytes(sheets, tmp_path):
    write_sheet(CubeModel.load("companion"), tmp_path / "other.pdf")
    assert sheets["companion"].read_bytes() == (tmp_path / "other.pdf").read_bytes()


@pytest.mark.parametrize(
    ("edge_mm", "paper", "words"),
    [
        (67, "a4", "at most 66 mm; --paper a3 takes 95 mm"),
        (120, "a4", "at most 66 mm"),
        (96, "a3", "at most 95 mm"),
        (60, "napkin", "use a4, letter, a3"),
        (5, "a4", "10 to 1000 mm"),
        (float("nan"), "a4", "10 to 1000 mm"),
    ],
)
def test_a_cube_that_does_not_fit_is_refused_and_leaves_no_file(tmp_path, edge_mm, paper, words):
    with pytest.raises(TrackingError, match=words) as caught:
        write_sheet(
            CubeModel.load("companion"), tmp_path / "cube.pdf", edge_mm=edge_mm, paper=paper
        )
    assert "\n" not in str(caught.value)
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("paper", some(PAPER_SIZES_MM))
def test_the_largest_edge_that_is_offered_does_fit(tmp_path, paper):
    cube = CubeModel.load("companion")
    write_sheet(cube, tmp_path / "cube.pdf", edge_mm=largest_edge_mm(paper), paper=paper)


def test_a_marker_larger_than_its_face_is_refused(tmp_path):
    cube = replace(CubeModel.load("companion"), marker_size=0.061)
    with pytest.raises(TrackingError, match="do not fit"):
        write_sheet(cube, tmp_path / "cube.pdf")


def test_a_missing_folder_is_refused_in_one_line(tmp_path):
    blank = replace(CubeModel.load("companion"), faces=())
    with pytest.raises(TrackingError, match=r"cannot write .*cube\.pdf"):
        write_sheet(blank, tmp_path / "no" / "cube.pdf")


@pytest.mark.parametrize(
    ("dictionary", "numbers"), [("DICT_4X4_50", range(50)), ("DICT_7X7_50", range(0, 50, 7))]
)
def test_marker_outlines_fill_to_the_marker(dictionary, numbers):
    for number in numbers:
        cells = marker_cells(dictionary, number)
        picture = np.zeros((len(cells) * 4,) * 2, np.uint8)
        for loop in marker_loops(dictionary, number):
            black = signed_area(loop) > 0
            corners = np.rint(loop * len(cells) * 4 * 16 - 8).astype(np.int32)
            cv2.fillPoly(picture, [corners], 1 if black else 0, shift=4)
        np.testing.assert_array_equal(picture[2::4, 2::4], cells)


@pytest.mark.parametrize("name", icons())
def test_icons_stay_in_their_square_and_are_told_apart_when_small(name):
    for loop in icon_paths(name):
        assert loop.min() >= 0
        assert loop.max() <= 1
    small = {other: icon_mask(other, 16).astype(int) for other in ICON_COLOURS}
    for other, mask in small.items():
        if other != name:
            assert np.abs(mask - icon_mask(name, 16)).mean() > 20
