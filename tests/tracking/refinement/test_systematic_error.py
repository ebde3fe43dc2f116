"""The stated systematic errors are the spread of the poses that such corners and lenses lead to."""

from dataclasses import replace

import cv2
import numpy as np
import pytest
from hypothesis import given, settings, strategies as st
from numpy.typing import NDArray
from scipy.optimize import least_squares

from cubeling.tracking.cube.model import CubeModel
from cubeling.tracking.geometry import se3
from cubeling.tracking.geometry.intrinsics import Intrinsics
from cubeling.tracking.geometry.projection import Projection
from cubeling.tracking.refinement.systematic_error import (
    COMMON_SHIFT_PX,
    CORNER_ERROR_M,
    CORNER_ERROR_PX,
    RESIDUAL_SHARE,
    UNSTATED_FOCAL,
    SystematicError,
)
from tests.examples import examples, some
from tests.tracking.drawn import CAMERA, held

Array = NDArray[np.float64]
Faces = tuple[str, ...]

CUBE = CubeModel.load("locomotion")
MEASURED_FOCAL = 0.002
MEASURED = replace(
    CAMERA,
    distortion=np.array([-0.1, 0.05, 0.001, -0.001, 0.0]),
    focal_deviation=MEASURED_FOCAL,
)
THREE: Faces = ("front", "right", "top")
"""The faces that `held()` shows."""


def corners_of(faces: Faces) -> Array:
    return np.concatenate([CUBE.face(name).corners for name in faces])


def shown(points: Array, pose: Array, camera: Intrinsics) -> Array:
    """Where a camera shows points of the cube, (N, 2) [px]."""
    turn, shift = cv2.Rodrigues(pose[:3, :3])[0], pose[:3, 3]
    pixels = cv2.projectPoints(points, turn, shift, camera.matrix, camera.distortion)[0]
    return np.asarray(pixels, np.float64).reshape(-1, 2)


def solved(points: Array, pixels: Array, start: Array, camera: Intrinsics) -> Array:
    """Pose delta from a pose to the one that least squares find for pixels, (6,)."""
    if not camera.distortion.any():
        return solved_with_k1(points, pixels, start)
    first = cv2.Rodrigues(start[:3, :3])[0], start[:3, 3:].copy()
    turn, shift = (
        np.asarray(each, np.float64).ravel()
        for each in cv2.solvePnPRefineLM(points, pixels, camera.matrix, camera.distortion, *first)
    )
    return se3.delta(start, se3.pose(se3.rotation(turn), shift))


def solved_with_k1(points: Array, pixels: Array, start: Array) -> Array:
    """Do the same where k1 stretches the cube about its own centre by an unknown amount."""

    def residuals(change: Array) -> Array:
        pose = se3.apply_delta(start, change[:6])
        seen = shown(points, pose, CAMERA)
        placed = points @ pose[:3, :3].T + pose[:3, 3]
        seen += change[6] * Projection(CAMERA).bends(placed, pose[:3, 3])
        off = (seen - pixels).ravel() / corner_error_px(start)
        return np.append(off, change[6] / CLAIMED_LENS[0])

    return np.asarray(
        least_squares(residuals, np.zeros(7), x_scale="jac", method="lm").x[:6], np.float64
    )


CLAIMED_LENS, MEASURED_LENS = (0.1, UNSTATED_FOCAL), (0.005, MEASURED_FOCAL)
"""Errors of k1 and of the focal length of a lens that claims none, and of one that was measured."""


def stated(pose: Array, faces: Faces, camera: Intrinsics = MEASURED) -> tuple[Array, Array]:
    k1_error = (MEASURED_LENS if camera.distortion.any() else CLAIMED_LENS)[0]
    by_corners, moves = SystematicError(CUBE, Projection(camera)).covariance(pose, faces, k1_error)
    return by_corners, moves @ moves.T


def ratios(one: Array, other: Array) -> Array:
    """Variances of one covariance along the principal axes of the other, over those, (6,)."""
    root = np.linalg.inv(np.linalg.cholesky(other))
    return np.asarray(np.linalg.eigvalsh(root @ one @ root.T), np.float64)


def corner_error_px(pose: Array) -> float:
    paper = CORNER_ERROR_M * CAMERA.matrix[0, 0] / pose[2, 3]
    return float(np.hypot(CORNER_ERROR_PX, paper))


def displaced(exact: Array, pose: Array, random: np.random.Generator) -> Array:
    """Corners in the image, each displaced by itself, and all together, (N, 2) [px]."""
    alone = random.normal(0, corner_error_px(pose), exact.shape)
    return exact + alone + random.normal(0, COMMON_SHIFT_PX, 2)


@pytest.mark.parametrize("distance", some([0.5, 0.25, 1.5]))
@pytest.mark.parametrize("faces", [THREE, ("front", "top")])
def test_the_covariance_is_the_spread_of_poses_of_bent_markers(
    distance: float, faces: Faces
) -> None:
    pose, random = held(at=(0.03, -0.02, distance)), np.random.default_rng(1)
    points = corners_of(faces)
    exact = shown(points, pose, MEASURED)
    deltas = [solved(points, displaced(exact, pose, random), pose, MEASURED) for _ in range(800)]
    spread = np.cov(np.array(deltas).T)
    along = ratios(stated(pose, faces)[0], spread)
    # Of 800 draws, the spread along an axis is known to a tenth; perspective is curved, too.
    assert along.min() > 0.7
    assert along.max() < 1.4


@pytest.mark.full  # a spread needs many poses
def test_the_covariance_is_the_spread_of_poses_where_k1_is_unknown() -> None:
    pose, random = held(at=(0.1, -0.07, 0.4)), np.random.default_rng(1)
    points = corners_of(THREE)
    placed = points @ pose[:3, :3].T + pose[:3, 3]
    exact, bends = shown(points, pose, CAMERA), Projection(CAMERA).bends(placed, pose[:3, 3])
    deltas = [
        solved(points, displaced(exact + bends * k1, pose, random), pose, CAMERA)
        for k1 in random.normal(0, CLAIMED_LENS[0], 300)
    ]
    along = ratios(stated(pose, THREE, CAMERA)[0], np.cov(np.array(deltas).T))
    assert along.min() > 0.6
    assert along.max() < 1.6


def test_a_lone_face_square_on_is_as_uncertain_as_its_tilt() -> None:
    """Least squares then find either lean, which the linear covariance alone would not tell."""
    pose, random = held(0.0, 0.0, 0.0, at=(0.0, 0.0, 0.7)), np.random.default_rng(2)
    points = corners_of(("front",))
    exact = shown(points, pose, MEASURED)
    corners = (displaced(exact, pose, random) for _ in range(400))
    tilts = [solved(points, each, pose, MEASURED)[3:5] for each in corners]
    found, claimed = (
        np.sqrt(np.diag(each)[:2])
        for each in (np.cov(np.array(tilts).T), stated(pose, ("front",))[0][3:5, 3:5])
    )
    assert (claimed > found / 2).all()
    assert (claimed < found * 2).all()


def test_edges_show_by_their_residual_how_far_corners_are_displaced() -> None:
    """Least squares take 6 of the 8 directions in which four corners may be displaced."""
    pose, random = held(0.5, 0.4, 0.2, at=(0.0, 0.0, 0.5)), np.random.default_rng(1)
    corners, shares = corners_of(("front",)), np.linspace(0, 1, 25)[:, None]
    ends = np.roll(corners, -1, axis=0)
    points = np.concatenate(
        [one + shares * (end - one) for one, end in zip(corners, ends, strict=True)]
    )
    at = shown(points, pose, CAMERA).reshape(4, -1, 2)
    along = at[:, -1] - at[:, 0]
    across = np.stack([-along[:, 1], along[:, 0]], axis=1)
    across /= np.linalg.norm(across, axis=1)[:, None]
    moved = [shown(points, se3.apply_delta(pose, 1e-5 * step), CAMERA) for step in np.eye(6)]
    slides = np.stack([((each.reshape(at.shape) - at) @ across[:, :, None]) for each in moved])
    basis = np.linalg.qr(slides.reshape(6, -1).T)[0]
    left = []
    for displaced_by in random.normal(0, 1, (400, 4, 2)):
        ahead = np.roll(displaced_by, -1, axis=0)
        off = displaced_by[:, None] + shares * (ahead - displaced_by)[:, None]
        normal = (off @ across[:, :, None]).ravel()
        left.append(np.mean((normal - basis @ (basis.T @ normal)) ** 2))
    assert np.sqrt(np.mean(left)) == pytest.approx(RESIDUAL_SHARE, rel=0.1)


def test_edges_that_lie_right_tell_of_a_better_print_than_most() -> None:
    pose, lens = held(0.1, 0.05, at=(0.0, 0.0, 0.5)), Projection(MEASURED)
    error, lone = SystematicError(CUBE, lens), ("front",)
    usual, right, wrong = (
        np.trace(error.covariance(pose, lone, MEASURED_LENS[0], 0.0, residual)[0][3:, 3:])
        for residual in (None, 0.01, 1.0)
    )
    assert right < usual / 1.5
    assert wrong == usual


@pytest.mark.parametrize(("camera", "lens"), [(CAMERA, CLAIMED_LENS), (MEASURED, MEASURED_LENS)])
def test_the_lens_moves_a_pose_as_stated(camera: Intrinsics, lens: tuple[float, float]) -> None:
    """Both of its errors move the corners of one picture together, and so the pose."""
    pose, points = held(at=(0.08, 0.05, 0.4)), corners_of(THREE)
    bent = camera.distortion + lens[0] * np.eye(len(camera.distortion))[0]
    longer = camera.matrix * np.array([[1 + lens[1]], [1 + lens[1]], [1.0]])
    longer[:2, 2] = camera.matrix[:2, 2]
    moves = np.array(
        [
            solved(points, shown(points, pose, other), pose, camera)
            for other in (replace(camera, distortion=bent), replace(camera, matrix=longer))
        ]
    )
    spread, claimed = moves.T @ moves, stated(pose, THREE, camera)[1]
    assert np.linalg.matrix_rank(claimed, tol=1e-6 * np.linalg.norm(claimed)) <= 2
    # As a share of what the axis varies by itself, if that is more than 0.1 mm or 0.006°.
    scale = np.maximum(np.sqrt(np.diag(spread)), 1e-4)
    assert np.abs((claimed - spread) / np.outer(scale, scale)).max() < 0.3


def test_a_longer_lens_is_a_cube_farther_away() -> None:
    """In the middle of the picture nothing else moves; where k1 hardly bends it either."""
    pose = held(at=(0.0, 0.0, 1.0))
    by_lens = stated(pose, THREE, CAMERA)[1]
    assert np.sqrt(by_lens[2, 2]) == pytest.approx(CLAIMED_LENS[1] * 1.0, rel=0.1)
    assert np.sqrt(np.diag(by_lens)[:2]).max() < 1e-4


def test_a_measured_lens_is_surer_than_one_that_claims_no_distortion() -> None:
    pose = held(at=(0.08, 0.05, 0.4))
    claimed, measured = (np.add(*stated(pose, THREE, each)) for each in (CAMERA, MEASURED))
    assert np.trace(measured[:3, :3]) < np.trace(claimed[:3, :3]) / 2
    # In the middle of the picture k1 bends nothing.
    pose = held(at=(0.0, 0.0, 1.0))
    by_corners = [stated(pose, THREE, each)[0] for each in (CAMERA, MEASURED)]
    assert np.allclose(ratios(*by_corners), 1, atol=0.1)


poses = st.builds(
    lambda x, y, z, distance: held(x, y, z, at=(0.02, 0.01, distance)),
    st.floats(0.3, 0.8), st.floats(0.3, 0.9), st.floats(-3, 3), st.floats(0.15, 2.5),
)  # fmt: skip


@settings(deadline=None, max_examples=examples(60))
@given(poses, st.permutations(THREE))
def test_fewer_faces_are_less_sure_in_every_direction(pose: Array, faces: list[str]) -> None:
    for count in (1, 2):
        fewer, more = (tuple(faces[:number]) for number in (count, count + 1))
        wider, narrower = stated(pose, fewer)[0], stated(pose, more)[0]
        assert ratios(wider, narrower).min() > 1 - 1e-6


@settings(deadline=None, max_examples=examples(60))
@given(poses)
def test_both_covariances_are_ones(pose: Array) -> None:
    for camera in (CAMERA, MEASURED):
        by_corners, by_lens = stated(pose, THREE, camera)
        for each in (by_corners, by_lens):
            assert np.allclose(each, each.T, rtol=1e-6, atol=1e-15)
        assert np.linalg.eigvalsh(by_corners).min() > 0
        assert np.linalg.eigvalsh(by_lens).min() > -1e-9 * np.trace(by_lens)
