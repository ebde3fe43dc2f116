"""Real photographs: no cube where there is none, and correct edges on paper.

The photographs are OpenCV's own samples; where they are absent these tests are skipped.
"""

import itertools
from functools import cache
from pathlib import Path

import cv2
import numpy as np
import pytest
from numpy.typing import NDArray

from cubeling.tracking.cube.model import FACE_AXES, CubeModel, Face, aruco_dictionary
from cubeling.tracking.detection.partly_hidden_markers import PartlyHiddenMarkerDetector
from cubeling.tracking.geometry import se3
from cubeling.tracking.geometry.intrinsics import Intrinsics
from tests.examples import some
from tests.tracking.showing import watch

Array = NDArray[np.float64]
Picture = NDArray[np.uint8]

PHOTOGRAPHS = Path(__file__).parents[3] / "shared" / "data" / "photographs"
ALL = sorted(
    [
        *PHOTOGRAPHS.glob("aruco/*.*g"),
        *PHOTOGRAPHS.glob("chessboard/*.jpg"),
        *sorted(PHOTOGRAPHS.glob("dodecahedron/*.jpg"))[::12],
    ]
)
FEW = list({path.parent: path for path in reversed(ALL)}.values())
"""The first of each folder."""

FEW_FIRST = [*FEW, *(path for path in ALL if path not in FEW)]
SINGLES, BOARD = (PHOTOGRAPHS / "aruco" / f"{name}original.jpg" for name in ("singlemarkers", "ch"))
DICTIONARY = "DICT_6X6_250"

pytestmark = pytest.mark.skipif(not ALL, reason="the photographs are not on this machine")


def photograph(path: Path) -> Picture:
    return np.asarray(cv2.imread(str(path)), np.uint8)


@cache
def camera(name: str) -> Intrinsics:
    """Read one of the camera files next to the photographs."""
    path = PHOTOGRAPHS / "aruco" / f"tutorial_camera_{name}.yml"
    storage = cv2.FileStorage(str(path), cv2.FILE_STORAGE_READ)
    matrix, distortion = (
        np.asarray(storage.getNode(key).mat(), np.float64)
        for key in ("camera_matrix", "distortion_coefficients")
    )
    return Intrinsics(matrix, distortion.ravel(), (640, 480))


def one_marker(number: int, marker_mm: float) -> CubeModel:
    """A cube of which only the front has a marker."""
    face = {"name": "front", "marker_id": number}
    document = {
        "dictionary": DICTIONARY,
        "edge_mm": 1.5 * marker_mm,
        "marker_mm": marker_mm,
        "face": [face],
    }
    return CubeModel.from_document(document, "test", "test")


@pytest.mark.slow(reason="two cubes are looked for in all four reflections")
@pytest.mark.parametrize("path", some(FEW_FIRST, len(FEW)), ids=lambda path: path.stem)
def test_no_bundled_cube_is_seen_in_any_photograph(path: Path) -> None:
    picture = photograph(path)
    own = path.parent / "camera.yaml"
    lens = Intrinsics.load(own) if own.exists() else camera("charuco")
    views = {
        "locomotion": (picture, picture[:, ::-1]),
        "companion": (picture[::-1], picture[::-1, ::-1]),
    }
    for name in views:
        for view in views[name]:
            whole = np.ascontiguousarray(view)
            states = watch(whole, CubeModel.load(name), lens)
            assert not any(state.visible for state in states)


@pytest.mark.full
def test_markers_on_a_real_sheet_have_the_same_pose() -> None:
    """Six markers, each a cube of its own, know nothing of each other; the paper is flat.

    Its lens is not that of the file to a percent, so sizes and tilts need not fit each other; but
    each of the six must lean as the others do, by what is seen of 40 px.
    """
    normals, refused = [], []
    for number in (23, 40, 62, 98, 124, 203):
        state = watch(photograph(SINGLES), one_marker(number, 40.0), camera("params"))[-1]
        refused.append(state.refused)
        if state.visible:
            assert state.camera_from_cube is not None
            normals.append(state.camera_from_cube[:3, 2])
    assert len(normals) >= 4, refused
    mean = np.mean(normals, axis=0)
    apart = np.rad2deg(np.arccos(np.array(normals) @ mean / np.linalg.norm(mean)))
    assert np.median(apart) < 3
    assert apart.max() < 6


def board() -> tuple[dict[int, Array], Array]:
    """Corners of the board's markers on the board, and `camera_from_board` by its chessboard."""
    size, marker = 0.04, 0.02
    layout = cv2.aruco.CharucoBoard((5, 7), size, marker, aruco_dictionary(DICTIONARY))
    seen, numbers = cv2.aruco.CharucoDetector(layout).detectBoard(photograph(BOARD))[:2]
    points = np.asarray(layout.getChessboardCorners(), np.float64)[np.ravel(numbers)]
    assert len(points) == 24
    lens = camera("charuco")
    _, turn, shift = cv2.solvePnP(points, np.asarray(seen), lens.matrix, lens.distortion)
    rotation = np.asarray(cv2.Rodrigues(turn)[0], np.float64)
    corners = zip(np.ravel(layout.getIds()).tolist(), layout.getObjPoints(), strict=True)
    places = {number: np.asarray(each, np.float64) for number, each in corners}
    return places, se3.pose(rotation, np.asarray(shift, np.float64).ravel())


@pytest.mark.full
@pytest.mark.parametrize("count", some([2, 17]))
@pytest.mark.slow(reason="each marker is looked for as a cube of its own")
def test_single_markers_of_a_real_board_are_right_or_refused(count: int) -> None:
    """25 px in a photograph often lean both ways alike; what is reported must be right."""
    places, camera_from_board = board()
    for number, corners in itertools.islice(places.items(), count):
        cube = one_marker(number, 20.0)
        for state in watch(photograph(BOARD), cube, camera("charuco")):
            if not state.visible:
                continue
            assert state.camera_from_cube is not None
            truth = corners @ camera_from_board[:3, :3].T + camera_from_board[:3, 3]
            found = cube.faces[0].corners @ state.camera_from_cube[:3, :3].T
            found += state.camera_from_cube[:3, 3]
            assert np.linalg.norm(found - truth, axis=1).max() < 0.01


def flat_model(places: dict[int, Array], numbers: list[int]) -> tuple[CubeModel, Array]:
    """Six markers of the board as the faces of one body, and `board_from_body`."""
    body = se3.pose(np.diag([1.0, -1.0, -1.0]), np.mean([places[n] for n in numbers], axis=(0, 1)))
    faces = tuple(
        Face(name, number, (places[number] - body[:3, 3]) @ body[:3, :3])
        for name, number in zip(FACE_AXES, numbers, strict=True)
    )
    return CubeModel("board", DICTIONARY, 0.03, 0.02, faces), body


@pytest.mark.full
@pytest.mark.slow(reason="the whole picture is searched for twelve bodies")
def test_edges_on_a_real_board_agree_with_its_chessboard() -> None:
    """Six markers of 20 mm at 40 cm, found by their edges, and 24 chessboard corners by OpenCV."""
    places, camera_from_board = board()
    random = np.random.default_rng(0)
    steps = []
    for _ in range(12):
        model, body = flat_model(places, random.permutation(17)[:6].tolist())
        state = watch(photograph(BOARD), model, camera("charuco"))[-1]
        if state.visible and len(state.faces) >= 4:
            assert state.camera_from_cube is not None
            steps.append(se3.delta(state.camera_from_cube, camera_from_board @ body))
    millimetres = 1000 * np.linalg.norm(np.array(steps)[:, :3], axis=1)
    degrees = np.rad2deg(np.linalg.norm(np.array(steps)[:, 3:], axis=1))
    assert len(steps) >= 4
    assert np.median(millimetres) < 1.0
    assert millimetres.max() < 3.0
    assert np.median(degrees) < 0.3
    assert degrees.max() < 1.5


def test_a_covered_marker_is_read_in_a_photograph() -> None:
    """Paint a grey thumb over one corner of each marker: OpenCV reads none, we most."""
    picture = cv2.cvtColor(photograph(SINGLES), cv2.COLOR_BGR2GRAY)
    dictionary = aruco_dictionary(DICTIONARY)
    detector = cv2.aruco.ArucoDetector(dictionary)
    squares, ids = detector.detectMarkers(picture)[:2]
    truth = {int(n): np.reshape(s, (4, 2)) for n, s in zip(np.ravel(ids), squares, strict=True)}
    for number, square in truth.items():
        corner, centre = square[number % 4], square.mean(axis=0)
        x, y = np.rint(corner + 0.15 * (centre - corner)).astype(int).tolist()
        cv2.circle(picture, (x, y), round(0.3 * np.sqrt(cv2.contourArea(square))), 150, -1)
    hidden = detector.detectMarkers(picture)[1]
    assert hidden is None or len(hidden) <= 1
    found = 0
    for number, square in truth.items():
        seen = PartlyHiddenMarkerDetector(one_marker(number, 40.0)).detect(np.asarray(picture))
        found += any(np.abs(each.corners - square).max() < 1.5 for each in seen)
    assert found >= 4
