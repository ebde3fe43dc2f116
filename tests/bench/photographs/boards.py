"""Photographs of markers on one sheet of paper: coplanar, parallel, and at known distances."""

from dataclasses import dataclass
from itertools import combinations
from pathlib import Path

import cv2
import numpy as np

from cubeling.tracking.geometry.intrinsics import Intrinsics
from tests.bench.photographs.dodecahedron import DICTIONARY, PHOTOGRAPHS, marker_poses
from tests.bench.photographs.marker_corners import (
    Array,
    Picture,
    opencv_corners,
    opencv_detector,
)
from tests.bench.photographs.pairs import tracked_marker
from tests.bench.photographs.scoring import StatedPose, chi_square, share
from tests.bench.tracking.scoring import MIN_WRONG_ERROR
from tests.bench.tracking.table import OURS

FOLDER = PHOTOGRAPHS / "aruco"

CHI2_95_PERCENT_OF_A_TILT = 5.991
"""95 % quantile of χ² with two degrees of freedom."""


@dataclass(frozen=True)
class Board:
    """A photograph of a sheet with markers."""

    name: str
    """For the table."""

    picture: Path
    """The photograph."""

    lens: Path
    """Its camera, as a file of OpenCV's."""

    side: float
    """Side of a marker's black square [m]."""

    places: dict[int, Array]
    """Middle of each marker on the sheet, (3,) [m]; {} where it is not known."""


@dataclass(frozen=True)
class BoardScore:
    """One tracker on the markers of a board, each by itself. NaN without a measurement."""

    board: str
    """Its name."""

    tracker: str
    """Title of the tracker."""

    markers: int
    """Markers that OpenCV detects with a fine window."""

    given: float
    """Share of them with a pose; of ours, a trusted one."""

    pairs: int
    """Pairs of poses."""

    wrong: int
    """Pairs that are more than 10° from parallel, or 20 mm from their distance."""

    parallel: float
    """Median angle between two markers' normals [rad]."""

    off_plane: float
    """Median distance of a marker's middle from the plane through all [m]."""

    spacing: float
    """Median error of the distance of two markers [m]."""

    inside: float
    """Share of the angles between normals that the stated 95 % regions of both markers hold."""


def boards() -> list[Board]:
    """The boards of OpenCV's predefined dictionaries; `gboriginal.png` has one of its own."""
    table = cv2.aruco.getPredefinedDictionary(getattr(cv2.aruco, DICTIONARY))
    layout = cv2.aruco.CharucoBoard((5, 7), 0.04, 0.02, table)
    squares = zip(np.ravel(layout.getIds()).tolist(), layout.getObjPoints(), strict=True)
    places = {marker: np.mean(square, axis=0) for marker, square in squares}
    charuco, params = (FOLDER / f"tutorial_camera_{name}.yml" for name in ("charuco", "params"))
    return [
        Board("ChArUco", FOLDER / "choriginal.jpg", charuco, 0.02, places),
        Board("six markers", FOLDER / "singlemarkersoriginal.jpg", params, 0.04, {}),
    ]


def load_lens(path: Path, size: tuple[int, int]) -> Intrinsics:
    """Read one of OpenCV's camera files for pictures of a size [px]."""
    storage = cv2.FileStorage(str(path), cv2.FILE_STORAGE_READ)
    matrix, distortion = (
        np.asarray(storage.getNode(key).mat(), np.float64)
        for key in ("camera_matrix", "distortion_coefficients")
    )
    return Intrinsics(matrix, distortion.ravel(), size)


def score_board(board: Board) -> list[BoardScore]:
    """Find each marker by itself, by ours and by OpenCV."""
    picture: Picture = np.asarray(cv2.imread(str(board.picture)), np.uint8)
    lens = load_lens(board.lens, (picture.shape[1], picture.shape[0]))
    markers = opencv_corners(opencv_detector(DICTIONARY, fine=True), picture)
    ours = {each: tracked_marker(picture, lens, each, board.side)[1] for each in markers}
    squares = opencv_corners(opencv_detector(DICTIONARY), picture).items()
    theirs = {
        each: StatedPose(marker_poses(square, lens, board.side)[0]) for each, square in squares
    }
    return [
        _score(board, OURS, len(markers), {m: pose for m, pose in ours.items() if pose}),
        _score(board, "cv2 IPPE", len(markers), theirs),
    ]


def _score(board: Board, tracker: str, markers: int, found: dict[int, StatedPose]) -> BoardScore:
    angles, spacings, inside = [], [], []
    for (one, a), (other, b) in combinations(found.items(), 2):
        angle, chi2 = tilt_between(a, b)
        angles.append(angle)
        if not np.isnan(chi2):
            inside.append(chi2 <= CHI2_95_PERCENT_OF_A_TILT)
        known = np.nan
        if board.places:
            known = float(np.linalg.norm(board.places[one] - board.places[other]))
        spacings.append(abs(float(np.linalg.norm(a.pose[:3, 3] - b.pose[:3, 3])) - known))
    # An unknown distance, NaN, is not wrong.
    tilted, misplaced = (
        np.array(angles) > MIN_WRONG_ERROR[1],
        np.array(spacings) > MIN_WRONG_ERROR[0],
    )
    return BoardScore(
        board.name,
        tracker,
        markers,
        len(found) / markers,
        len(angles),
        int(np.count_nonzero(tilted | misplaced)),
        float(np.median(angles)) if angles else np.nan,
        _off_plane(np.array([each.pose[:3, 3] for each in found.values()])),
        float(np.median(spacings)) if spacings else np.nan,
        share(inside),
    )


def tilt_between(one: StatedPose, other: StatedPose) -> tuple[float, float]:
    """Angle between two markers' normals [rad], and χ² of it (2 degrees of freedom) or NaN."""
    normals = one.pose[:3, 2], other.pose[:3, 2]
    angle = float(np.arctan2(np.linalg.norm(np.cross(*normals)), normals[0] @ normals[1]))
    if one.covariance is None or other.covariance is None:
        return angle, np.nan
    # Turns about the normal do not tilt.
    axes = one.pose[:3, :2]
    turn = np.cross(*normals) @ axes
    both = one.covariance[3:, 3:] + other.covariance[3:, 3:]
    return angle, chi_square(turn, axes.T @ both @ axes)


def _off_plane(middles: Array) -> float:
    """Median distance of points from the plane through them [m]; NaN for fewer than four."""
    if len(middles) < 4:
        return np.nan
    centred = middles - middles.mean(axis=0)
    return float(np.median(np.abs(centred @ np.linalg.svd(centred)[2][2])))
