"""Calibration from rendered images with a known lens, and from photographs."""

from dataclasses import replace
from pathlib import Path

import cv2
import numpy as np
import pypdfium2
import pytest

from cubeling.tracking import CubeModel, Frame, Intrinsics, TrackingError, calibrate_camera
from cubeling.tracking.calibration import (
    Board,
    BoardFinder,
    CubeFinder,
    ViewCollector,
    calibrate,
    measured_cube,
    write_board,
)
from cubeling.tracking.calibration.model import CalibrationTarget
from cubeling.tracking.calibration.solver import fit_poses
from cubeling.tracking.calibration.view import view_of_corners
from cubeling.tracking.geometry import se3
from cubeling.tracking.synthetic import open_synthetic
from tests.tracking.calibration.waved import aligned

PHOTOGRAPHS = Path(__file__).parents[4] / "shared" / "data" / "photographs"
needs_photographs = pytest.mark.skipif(not PHOTOGRAPHS.is_dir(), reason="no photographs here")

STOP_S, IN_STOP_S = 0.74, 0.12
"""From one stop of the motion to the next, and a time within each at which the cube is still."""


def photograph(*names):
    grey = cv2.imread(str(PHOTOGRAPHS.joinpath(*names)), cv2.IMREAD_GRAYSCALE)
    return np.asarray(grey, np.uint8)


@pytest.mark.full  # the test of the command waves a cube too
def test_waving_a_cube_determines_lens_and_folding_errors():
    source = open_synthetic("wave?fold=0.8&seed=4&clutter=0&noise=3&size=960x540")
    cube = CubeModel.load("locomotion")
    finder = CubeFinder(cube)
    collector = ViewCollector(finder, source.size)
    verdicts = []
    for stop in range(27):
        still = source.frame(round((STOP_S * stop + IN_STOP_S) * 30))
        for earlier in (1 / 15, 0.0):  # the second one shows that it is still
            seen = replace(still, timestamp=still.timestamp - earlier)
            verdicts.append(collector.update(seen).verdict)
    assert verdicts.count("taken") >= 20
    found = calibrate(collector.views, finder.target(source.size))
    truth = source.intrinsics
    assert truth is not None
    assert found.intrinsics.matrix[0, 0] == pytest.approx(truth.matrix[0, 0], rel=0.002)
    assert found.intrinsics.matrix[1, 1] == pytest.approx(truth.matrix[1, 1], rel=0.002)
    np.testing.assert_allclose(found.intrinsics.matrix[:2, 2], truth.matrix[:2, 2], atol=2.5)
    real = np.array([face.corners for face in source.cube.faces])
    ideal = np.array([face.corners for face in cube.faces])
    measured = np.array([face.corners for face in measured_cube(cube, found.plates).faces])
    assert aligned(ideal, real).max() > 0.0008
    assert aligned(measured, real).max() < 0.0001


def test_frames_without_a_cube_are_refused():
    with pytest.raises(TrackingError, match="no frame"):
        calibrate_camera([], CubeModel.load("locomotion"))
    blank = np.full((360, 640, 3), 128, np.uint8)
    with pytest.raises(TrackingError, match="0 of 8"):
        calibrate_camera([Frame(blank, 0.0, 0)], CubeModel.load("locomotion"))


def test_a_moving_cube_and_a_view_seen_before_are_not_taken():
    source = open_synthetic("wave?seed=4&clutter=0&size=640x360")
    collector = ViewCollector(CubeFinder(CubeModel.load("locomotion")), source.size)
    still, moving = source.frame(3), source.frame(14)
    assert collector.update(still).verdict == "moving", "the first frame tells no speed"
    again = Frame(still.image, still.timestamp + 1 / 30, 1)
    assert collector.update(again).verdict == "taken"
    assert collector.update(Frame(still.image, still.timestamp + 2 / 30, 2)).verdict == "known"
    assert collector.update(moving).verdict in ("moving", "unseen")
    blank = np.full_like(still.image, 128)
    assert collector.update(Frame(blank, 9.0, 3)).verdict == "unseen"
    assert len(collector.views) == 1


def test_the_printed_board_is_detected_where_it_is_drawn(tmp_path):
    path = tmp_path / "board.pdf"
    board = write_board(path)
    assert board.square == pytest.approx(0.037)
    page = pypdfium2.PdfDocument(path)[0]
    scale = 4.0
    picture = np.asarray(page.render(scale=scale).to_pil().convert("L"))
    finder = BoardFinder(board)
    found = finder.find(picture, 0.0)
    assert found is not None
    assert len(found.corners.points) == 2 * 24
    pixels_of_mm = scale * 72 / 25.4
    corner = np.array([(210 - 5 * 37) / 2, 12])
    wanted = (corner + found.corners.points[:, :2] * 1000) * pixels_of_mm - 0.5
    assert np.abs(found.corners.pixels - wanted).max() < 1.0


def test_unknown_paper_and_unwritable_paths_are_refused(tmp_path):
    with pytest.raises(TrackingError, match="choose a4, letter, a3"):
        write_board(tmp_path / "board.pdf", "a9")
    with pytest.raises(TrackingError, match=r"cannot write .*board\.pdf"):
        write_board(tmp_path / "none" / "board.pdf")


@pytest.mark.slow(reason="a camera is calibrated twice, by OpenCV too")
@needs_photographs
def test_photographs_of_a_chessboard_give_the_camera_that_opencv_finds():
    points = np.array([(x * 0.025, y * 0.025, 0) for y in range(6) for x in range(9)])
    seen = []
    for path in sorted((PHOTOGRAPHS / "chessboard").glob("*.jpg")):
        grey = photograph("chessboard", path.name)
        good, corners = cv2.findChessboardCorners(grey, (9, 6))
        assert good
        criteria = (cv2.TERM_CRITERIA_COUNT | cv2.TERM_CRITERIA_EPS, 40, 1e-3)
        seen.append(cv2.cornerSubPix(grey, corners, (7, 7), (-1, -1), criteria))
    views = [
        view_of_corners(
            0.0, np.zeros(54, np.intp), points, np.asarray(corners, np.float64).reshape(-1, 2)
        )
        for corners in seen
    ]
    target = CalibrationTarget(
        (640, 480), np.ones(9, np.bool_), points.mean(axis=0)[None], adjust_plates=False
    )
    found = calibrate(views, target)
    found.check()
    flat = [points.astype(np.float32)] * len(seen)
    theirs = cv2.calibrateCamera(flat, seen, (640, 480), None, None)[1]
    np.testing.assert_allclose(found.intrinsics.matrix, theirs, rtol=0.001, atol=0.6)
    assert found.intrinsics.matrix[0, 0] == pytest.approx(535.9, rel=0.01)  # left_intrinsics.yml
    assert found.residual < 0.2


@needs_photographs
def test_one_photograph_of_a_board_fits_its_camera_but_does_not_determine_it():
    folder = PHOTOGRAPHS / "aruco"
    grey = photograph("aruco", "choriginal.jpg")
    file = cv2.FileStorage(str(folder / "tutorial_camera_charuco.yml"), cv2.FILE_STORAGE_READ)
    camera = Intrinsics(
        np.asarray(file.getNode("camera_matrix").mat(), np.float64),
        np.asarray(file.getNode("distortion_coefficients").mat(), np.float64).ravel(),
        (640, 480),
    )
    finder = BoardFinder(Board())
    found = finder.find(grey, 0.0)
    assert found is not None
    view = finder.measure(grey, found)
    assert view is not None
    assert len(view.points) == 2 * 24
    target = finder.target(camera.size)
    numbers = np.array([*camera.matrix[[0, 1, 0, 1], [0, 1, 2, 2]], *camera.distortion])
    model, kept = fit_poses([view] * 8, numbers, target)
    away = model.residuals(kept)[0]
    assert np.sqrt((away**2).mean()) < 0.8
    with pytest.raises(TrackingError, match="tilted more"):
        calibrate([view] * 8, target).check()


def rays_of(camera):
    """The direction that each pixel sees, (H, W, 3)."""
    width, height = camera.size
    x, y = np.meshgrid(np.arange(width), np.arange(height))
    straight = camera.undistort(np.stack([x, y], axis=-1).astype(np.float64))
    rays = np.concatenate([straight, np.ones((height, width, 1))], axis=-1)
    return rays @ np.linalg.inv(camera.matrix).T


def board_picture(board, rays, pose):
    """The board as a camera sees it, (H, W): each pixel's ray meets the board's plane."""
    turn, origin = pose[:3, :3], pose[:3, 3]
    reach = (origin @ turn[:, 2]) / (rays @ turn[:, 2])
    places = (reach[..., None] * rays - origin) @ turn
    dots = 40  # a square
    texture = board.pattern.generateImage((5 * dots, 7 * dots), marginSize=0)
    texture = cv2.copyMakeBorder(texture, dots, dots, dots, dots, cv2.BORDER_CONSTANT, value=255)
    u, v = ((places[..., axis] / board.square + 1) * dots - 0.5 for axis in (0, 1))
    seen = cv2.remap(
        cv2.GaussianBlur(texture, (0, 0), 0.8),
        u.astype(np.float32),
        v.astype(np.float32),
        cv2.INTER_LINEAR,
        borderValue=120,
    )
    return cv2.cvtColor(cv2.GaussianBlur(seen, (0, 0), 0.6), cv2.COLOR_GRAY2BGR)


@pytest.mark.full
@pytest.mark.slow(reason="a camera is calibrated from 12 drawn pictures")
def test_waving_a_board_determines_the_lens():
    matrix = np.array([[610.0, 0, 325], [0, 611, 236], [0, 0, 1]])
    camera = Intrinsics(matrix, np.array([-0.15, 0.07, 0.0005, -0.0005, 0]), (640, 480))
    board = Board()
    finder = BoardFinder(board)
    collector = ViewCollector(finder, camera.size)
    random, rays = np.random.default_rng(3), rays_of(camera)
    for stop in range(12):
        way = 2 * np.pi * stop / 4
        tilt = np.deg2rad(random.uniform(20, 40)) * np.array([np.cos(way), np.sin(way), 0])
        turn = se3.rotation(tilt) @ se3.rotation(np.array([0, 0, random.uniform(-0.5, 0.5)]))
        middle = np.array([*random.uniform(-0.09, 0.09, 2), random.uniform(0.30, 0.42)])
        pose = se3.pose(turn, middle - turn @ board.points.mean(axis=0))
        picture = board_picture(board, rays, pose)
        for shift in (0.0, 0.05):
            collector.update(Frame(picture, stop + shift, 0))
    found = calibrate(collector.views, finder.target(camera.size))
    found.check()
    assert len(collector.views) >= 9
    assert found.intrinsics.matrix[0, 0] == pytest.approx(610, rel=0.005)
    assert found.intrinsics.matrix[1, 1] == pytest.approx(611, rel=0.005)
    np.testing.assert_allclose(found.intrinsics.matrix[:2, 2], (325, 236), atol=4)
