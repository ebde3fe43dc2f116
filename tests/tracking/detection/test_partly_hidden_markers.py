"""Markers with a finger on a corner are found, and where their corners are."""

import cv2
import numpy as np
import pytest
from numpy.typing import NDArray

from cubeling.tracking.cube.faces import FacePlanes
from cubeling.tracking.cube.model import CubeModel, aruco_dictionary
from cubeling.tracking.detection.markers import Observation
from cubeling.tracking.detection.partly_hidden_markers import PartlyHiddenMarkerDetector
from cubeling.tracking.geometry.intrinsics import Intrinsics
from cubeling.tracking.geometry.projection import Projection
from cubeling.tracking.synthetic import open_synthetic
from tests.examples import some

Array = NDArray[np.float64]
Picture = NDArray[np.uint8]

SKIN, PALE, DARK = (90, 120, 170), (150, 175, 220), (45, 45, 48)
"""Colours of fingers, BGR: the last that of a glove as dark as the print."""

FRAMES = tuple(range(0, 300, 30))
CUBE = CubeModel.load("locomotion")
DETECTOR = PartlyHiddenMarkerDetector(CUBE)


def true_markers(cube: CubeModel, pose: Array, camera: Intrinsics) -> dict[str, Array]:
    """Corners of every marker that can be read, where they truly are [px]."""
    projection = Projection(camera)
    found = {}
    for number in FacePlanes(cube).faces_towards(pose, 0.3):
        face = cube.faces[number]
        corners = projection.project(face.corners @ pose[:3, :3].T + pose[:3, 3])
        if side_of(corners) > 28:
            found[face.name] = corners
    return found


def side_of(corners: Array) -> float:
    return float(np.sqrt(cv2.contourArea(corners.astype(np.float32))))


def finger(
    corners: Array, corner: int, random: np.random.Generator, shape: tuple[int, ...]
) -> Array:
    """Cover of a round-tipped finger over one corner of a marker, (H, W), 0…1.

    It reaches a sixth to a third of a side into the marker and is a third of one wide.
    """
    side, inward = side_of(corners), corners.mean(axis=0) - corners[corner]
    inward /= np.linalg.norm(inward)
    cos, sin = np.cos(turn := random.uniform(-0.6, 0.6)), np.sin(turn)
    way = np.array([[cos, -sin], [sin, cos]]) @ inward
    width = side * random.uniform(0.28, 0.4)
    tip = corners[corner] + inward * side * random.uniform(0.15, 0.33) - way * width / 2
    mask = np.zeros(shape, np.float32)
    (x, y), (u, v) = np.rint(16 * np.stack([tip - 2.5 * side * way, tip])).astype(int).tolist()
    cv2.line(mask, (x, y), (u, v), 1.0, round(width), cv2.LINE_8, 4)
    cv2.circle(mask, (u, v), round(8 * width), 1.0, -1, cv2.LINE_8, 4)
    return np.asarray(cv2.GaussianBlur(mask, (0, 0), 0.8), np.float64)


def with_fingers(
    image: Picture, markers: dict[str, Array], color: tuple[int, int, int], seed: int
) -> Picture:
    """Lay one finger over one corner of every marker."""
    random = np.random.default_rng(seed)
    picture = image.astype(np.float64)
    for corners in markers.values():
        cover = finger(corners, int(random.integers(4)), random, image.shape[:2])
        round_form = 0.75 + 0.25 * cv2.GaussianBlur(cover, (0, 0), side_of(corners) / 12)
        light = round_form[..., None] * np.array(color)
        picture += cover[..., None] * (light - picture)
    picture += random.normal(0, 1, picture.shape)
    return np.clip(np.rint(picture), 0, 255).astype(np.uint8)


def grey_of(image: Picture) -> Picture:
    return np.asarray(cv2.cvtColor(image, cv2.COLOR_BGR2GRAY), np.uint8)


def off(seen: Observation, markers: dict[str, Array]) -> float:
    """Largest error of a corner, in cells of the marker; infinite where there is no such marker."""
    if seen.face.name not in markers:
        return np.inf
    true = markers[seen.face.name]
    return float(np.linalg.norm(seen.corners - true, axis=1).max() / side_of(true) * 6)


@pytest.fixture(scope="module")
def scenes() -> list[tuple[Picture, dict[str, Array]]]:
    """Pictures of the cube in the air, and the markers that they show."""
    source = open_synthetic("poses")
    assert source.intrinsics is not None
    scenes = []
    for number in FRAMES:
        markers = true_markers(source.cube, source.truth(number), source.intrinsics)
        points = np.concatenate(list(markers.values()))
        left, top = np.maximum(points.min(axis=0) - 90, 0).astype(int).tolist()
        right, bottom = (points.max(axis=0) + 90).astype(int).tolist()
        image = source.frame(number).image[top:bottom, left:right]
        scenes.append((image, {name: each - (left, top) for name, each in markers.items()}))
    return scenes


@pytest.mark.parametrize("color", some([(SKIN,), (PALE,), (DARK,)]))
def test_with_a_finger_on_a_corner_of_every_marker_some_are_found(
    scenes: list[tuple[Picture, dict[str, Array]]], color: tuple[int, int, int]
) -> None:
    best, right, count = [], 0, 0
    for number, (image, markers) in enumerate(scenes):
        covered = with_fingers(image, markers, color, number)
        errors = [off(seen, markers) for seen in DETECTOR.detect(grey_of(covered))]
        best.append(min(errors, default=np.inf))
        right += sum(error < 0.15 for error in errors)
        count += len(markers)
    assert max(best) < 0.15
    assert right > 0.7 * count


def test_opencv_finds_few_of_the_same_markers(
    scenes: list[tuple[Picture, dict[str, Array]]],
) -> None:
    """Or the drawings above would prove nothing."""
    detector = cv2.aruco.ArucoDetector(aruco_dictionary(CUBE.dictionary))
    found = 0
    for number, (image, markers) in enumerate(scenes):
        ids = detector.detectMarkers(with_fingers(image, markers, DARK, number))[1]
        seen = set(np.ravel(ids).tolist()) if ids is not None else set()
        found += sum(CUBE.face(name).marker_id in seen for name in markers)
    assert found < 0.3 * sum(len(markers) for _, markers in scenes)


def test_whole_markers_are_found_to_a_twentieth_of_a_cell(
    scenes: list[tuple[Picture, dict[str, Array]]],
) -> None:
    for image, markers in scenes:
        errors = {seen.face.name: off(seen, markers) for seen in DETECTOR.detect(grey_of(image))}
        assert set(errors) >= set(markers)
        assert max(errors[name] for name in markers) < 0.05


def test_a_marker_with_a_corner_outside_the_image_is_found(
    scenes: list[tuple[Picture, dict[str, Array]]],
) -> None:
    tried = 0
    for image, markers in scenes:
        for name, corners in markers.items():
            left = np.sort(corners[:, 0])
            deep = 0.6 * (left[1] - left[0])
            if deep < 0.2 * side_of(corners):
                continue  # one corner cannot be cut off without the next
            cut = int(left[0] + min(deep, 0.25 * side_of(corners)))
            found = DETECTOR.detect(grey_of(image[:, cut:]))
            there = {name: corners - (cut, 0)}
            assert min((off(seen, there) for seen in found), default=np.inf) < 0.15
            tried += 1
    assert tried >= 4


def test_markers_of_other_cubes_are_not_found() -> None:
    own = {face.marker_id for face in CUBE.faces}
    for number in range(50):
        picture = np.full((160, 160), 210, np.uint8)
        dictionary = aruco_dictionary(CUBE.dictionary)
        picture[35:125, 35:125] = cv2.aruco.generateImageMarker(dictionary, number, 90) // 2 + 20
        found = {seen.face.marker_id for seen in DETECTOR.detect(picture)}
        assert found == ({number} & own)


def test_no_marker_is_found_in_an_image_without_markers() -> None:
    random = np.random.default_rng(0)
    noise = random.integers(0, 256, (300, 400)).astype(np.uint8)
    square = np.full((200, 200), 255, np.uint8)
    square[60:140, 60:140] = 0
    for picture in (
        np.zeros((90, 120), np.uint8),
        np.full((90, 120), 255, np.uint8),
        noise,
        square,
    ):
        assert DETECTOR.detect(picture) == []
    assert DETECTOR.detect(square[50:52, 50:52]) == []
