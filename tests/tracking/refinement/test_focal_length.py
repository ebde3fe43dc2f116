"""Corners of a cube tell the focal length of the lens that shows them, and how surely."""

from collections.abc import Iterator
from dataclasses import replace

import cv2
import numpy as np
import pytest
from numpy.typing import NDArray

from cubeling.tracking.cube.model import CubeModel
from cubeling.tracking.geometry.intrinsics import Intrinsics
from cubeling.tracking.refinement.face_corners import FaceCorners
from cubeling.tracking.refinement.focal_length import FocalLengthEstimator
from tests.examples import some
from tests.tracking.drawn import CAMERA, held

Array = NDArray[np.float64]

CUBE = CubeModel.load("locomotion")
FACES = ("front", "right", "top")
"""The faces that `held()` shows."""
GUESS = replace(CAMERA, focal_deviation=0.35)
NOISE_PX = 0.1


def pictures(
    lens: Intrinsics, seed: int, count: int, cube: CubeModel = CUBE
) -> Iterator[list[FaceCorners]]:
    """Where a lens shows the corners of a cube that is turned and moved, with noise."""
    random = np.random.default_rng(seed)
    for _ in range(count):
        about_x, about_y, about_z = random.uniform((0.3, 0.4, -1.0), (0.8, 0.9, 1.0)).tolist()
        depth = float(random.uniform(0.25, 0.45))
        x, y = (depth * random.uniform(-1, 1, 2) * (0.3, 0.2)).tolist()
        pose = held(about_x, about_y, about_z, at=(x, y, depth))
        yield [
            FaceCorners(
                name,
                seen(cube.face(name).corners, pose, lens) + random.normal(0, NOISE_PX, (4, 2)),
                NOISE_PX,
            )
            for name in FACES
        ]


def seen(points: Array, pose: Array, lens: Intrinsics) -> Array:
    turn = cv2.Rodrigues(pose[:3, :3])[0]
    pixels = cv2.projectPoints(points, turn, pose[:3, 3], lens.matrix, lens.distortion)[0]
    return np.asarray(pixels, np.float64).reshape(-1, 2)


def folded(seed: int) -> CubeModel:
    """A cube whose corners are off as those of paper are."""
    random = np.random.default_rng(seed)
    faces = [
        replace(face, corners=face.corners + random.normal(0, 0.00015, (4, 3)))
        for face in CUBE.faces
    ]
    return replace(CUBE, faces=tuple(faces))


@pytest.mark.parametrize("factor", [1.7, 1 / 1.7])
@pytest.mark.parametrize("seed", some([1, 2]))
def test_a_wrong_guess_is_corrected_and_never_surer_than_it_is_right(
    factor: float, seed: int
) -> None:
    estimator = FocalLengthEstimator([CUBE], GUESS.lengthen(factor, 0.35))
    for faces in pictures(CAMERA, seed, 40, folded(seed)):
        estimator.learn(faces)
        found = estimator.estimate
        assert abs(np.log(found.scale * factor)) < 3 * found.deviation
    assert abs(found.scale * factor - 1) < 0.03
    assert found.deviation < 0.02


@pytest.mark.full  # a spread needs many cubes
def test_the_stated_deviation_is_the_spread_over_cubes_of_bent_paper() -> None:
    """Many pictures of one cube have its paper in common, which averaging does not remove."""
    errors = []
    for seed in range(12):
        estimator = FocalLengthEstimator([CUBE], GUESS)
        for faces in pictures(CAMERA, seed, 15, folded(seed)):
            estimator.learn(faces)
        errors.append(np.log(estimator.estimate.scale) / estimator.estimate.deviation)
    assert 0.4 < np.sqrt(np.mean(np.square(errors))) < 1.6


def test_a_picture_like_those_before_tells_nothing_new() -> None:
    estimator = FocalLengthEstimator([CUBE], GUESS)
    first = next(pictures(CAMERA, 1, 1))
    estimator.learn(first)
    found = estimator.estimate
    assert found.deviation < 0.35
    for _ in range(5):
        estimator.learn([replace(each, corners=each.corners + 0.05) for each in first])
    assert estimator.estimate == found


def test_two_cubes_tell_one_lens_more_surely_than_each_alone() -> None:
    """Each is bent in its own way, and their pictures take turns."""
    random, cubes = np.random.default_rng(1), [folded(1), folded(2)]
    both = FocalLengthEstimator([CUBE, CUBE], GUESS.lengthen(1.7, 0.35))
    alone = [FocalLengthEstimator([CUBE], GUESS.lengthen(1.7, 0.35)) for _ in cubes]
    shown = [pictures(CAMERA, int(random.integers(99)), 12, cube) for cube in cubes]
    for faces in zip(*shown, strict=True):
        for number, each in enumerate(faces):
            both.learn(each, number)
            alone[number].learn(each)
            assert abs(np.log(both.estimate.scale * 1.7)) < 3 * both.estimate.deviation
    assert both.estimate.deviation < min(each.estimate.deviation for each in alone)
    assert abs(both.estimate.scale * 1.7 - 1) < 0.03


def test_a_lone_face_tells_nothing() -> None:
    estimator = FocalLengthEstimator([CUBE], GUESS)
    for faces in pictures(CAMERA, 1, 5):
        estimator.learn(faces[:1])
    assert estimator.estimate.deviation == 0.35


def test_a_flat_sheet_is_no_cube() -> None:
    """Markers side by side in one plane fit no cube, whatever the lens."""
    estimator = FocalLengthEstimator([CUBE], GUESS)
    front = CUBE.face("front").corners
    edge = np.array([CUBE.edge, 0.0, 0.0])
    for turn in (0.3, 0.6, 0.9):
        pose = held(turn, turn, 0.2)
        sheet = {"front": front, "right": front + edge, "left": front - edge}
        estimator.learn(
            [FaceCorners(name, seen(each, pose, CAMERA), 0.1) for name, each in sheet.items()]
        )
    assert estimator.estimate.deviation == 0.35
