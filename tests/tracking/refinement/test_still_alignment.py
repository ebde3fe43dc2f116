"""A cube at rest is aligned by all cells of its markers, whatever the focus and the light."""

from dataclasses import replace

import cv2
import numpy as np
import pytest
from hypothesis import given, settings, strategies as st
from numpy.typing import NDArray

from cubeling.tracking.cube.faces import FacePlanes, face_frame
from cubeling.tracking.cube.model import CubeModel
from cubeling.tracking.geometry import se3
from cubeling.tracking.geometry.image_region import Patch
from cubeling.tracking.geometry.projection import Projection
from cubeling.tracking.refinement.evidence import Evidence
from cubeling.tracking.refinement.photometry.still_alignment import StillAligner, StillAlignment
from tests.examples import examples, some
from tests.tracking.drawn import held
from tests.tracking.refinement.seen_softly import CAMERA, corners_off, drawn, patch

Array = NDArray[np.float64]

CUBE = CubeModel.load("locomotion")
CELL = CUBE.marker_size / 6
ALIGNER = StillAligner(CUBE, Projection(CAMERA))
THREE = ("front", "right", "top")
"""The faces that `held()` shows."""

PIXEL_BLUR = 0.4
"""Pixels, and the sampling between them, blur by about this much, one standard deviation [px]."""


def distance_of(cell_px: float) -> float:
    """Distance at which a cell that faces the camera is so large [m]."""
    return float(CAMERA.matrix[0, 0]) * CELL / cell_px


def half_a_cell_off(pose: Array, seed: int) -> Array:
    """A pose 0.4 cells sideways, 2 % in distance and 3° in tilt away."""
    random = np.random.default_rng(seed)
    way, tilt = random.uniform(0, 2 * np.pi), random.normal(size=3)
    aside = 0.4 * CELL * np.array([np.cos(way), np.sin(way)])
    tilt *= np.deg2rad(3) / np.linalg.norm(tilt)
    depth = 0.02 * pose[2, 3] * random.choice([-1, 1])
    return se3.apply_delta(pose, np.array([*aside, depth, *tilt]))


def aligned(seen: Patch, start: Array) -> StillAlignment:
    found = ALIGNER.align(seen, start)
    assert found is not None
    return found


def off_px(found: StillAlignment, truth: Array) -> float:
    return corners_off(CUBE, found.camera_from_cube, truth, tuple(found.correlations))


@settings(deadline=None, max_examples=examples(15), derandomize=True)
@given(
    cell_px=st.floats(2.5, 9.0),
    blur_cells=st.floats(0.0, 0.25),
    bloom=st.floats(0.0, 0.4),
    slope=st.tuples(st.floats(-0.2, 0.2), st.floats(-0.2, 0.2)),
    turn=st.tuples(st.floats(0.4, 0.7), st.floats(0.4, 0.9), st.floats(-3, 3)),
    seed=st.integers(0, 99),
)
def test_the_pose_is_found_from_half_a_cell_off_in_any_focus_and_light(
    cell_px: float,
    blur_cells: float,
    bloom: float,
    slope: tuple[float, float],
    turn: tuple[float, float, float],
    seed: int,
) -> None:
    pose = held(*turn, at=(0.004, -0.006, distance_of(cell_px)))
    blur = max(0.6, blur_cells * cell_px)
    found = aligned(patch(drawn(CUBE, pose, blur, bloom, slope)), half_a_cell_off(pose, seed))
    assert off_px(found, pose) < 0.4
    assert min(found.correlations.values()) > 0.85


@pytest.mark.parametrize("blur", some([1.2, 0.6, 2.5]))
def test_the_blur_is_measured(blur: float) -> None:
    pose = held(at=(0.004, -0.006, distance_of(8)))
    for bloom in (0.0, 0.4):
        found = aligned(patch(drawn(CUBE, pose, blur, bloom)), half_a_cell_off(pose, 1))
        assert found.blur == pytest.approx(np.hypot(blur, PIXEL_BLUR), rel=0.12)
        assert off_px(found, pose) < 0.3


@pytest.mark.parametrize("bloom", some([0.4, 0.0, 0.2]))
@pytest.mark.parametrize("cell_px", [3.2, 5.6])
def test_the_bloom_is_measured(bloom: float, cell_px: float) -> None:
    pose = held(at=(0.004, -0.006, distance_of(cell_px)))
    found = aligned(patch(drawn(CUBE, pose, 0.7, bloom)), half_a_cell_off(pose, 2))
    assert found.bloom == pytest.approx(bloom, abs=0.1)


def test_cells_of_two_pixels_are_enough() -> None:
    pose = held(at=(0.004, -0.006, distance_of(2.0)))
    for seed in range(4):
        seen = patch(drawn(CUBE, pose, 0.6, 0.2, (0.1, -0.1)), seed=seed)
        found = aligned(seen, half_a_cell_off(pose, seed))
        assert off_px(found, pose) < 0.2


@pytest.mark.parametrize("cell_px", [3.2, 7.5])
@pytest.mark.parametrize("skin", some([0.35, 0.05, 0.6]))
def test_a_finger_over_a_third_of_a_marker_leaves_the_pose(cell_px: float, skin: float) -> None:
    pose = held(at=(0.004, -0.006, distance_of(cell_px)))
    covers = {"front": (-0.1, -0.1, 1 / 3, 1.1)}
    found = aligned(patch(drawn(CUBE, pose, covers=covers, skin=skin)), half_a_cell_off(pose, 3))
    assert off_px(found, pose) < 0.5
    # What is left of the marker fits, and about two thirds are left; black skin covers white only.
    alike, share = found.visible["front"]
    assert alike > 0.95
    assert 0.55 < share < 0.95
    assert alike > found.correlations["front"]
    for free in ("right", "top"):
        assert found.visible[free][1] > 0.85


def test_the_light_of_each_face_is_its_own() -> None:
    """A slope of it moves nothing."""
    pose = held(at=(0.004, -0.006, distance_of(7)))
    even, sloping = (
        aligned(patch(drawn(CUBE, pose, slope=slope)), half_a_cell_off(pose, 4))
        for slope in ((0.0, 0.0), (0.3, -0.3))
    )
    apart = corners_off(CUBE, even.camera_from_cube, sloping.camera_from_cube, THREE)
    assert apart < 0.1


def test_the_covariance_is_at_least_the_spread_under_noise() -> None:
    """And not ten times as wide."""
    pose = held(at=(0.004, -0.006, distance_of(3)))
    light, start = drawn(CUBE, pose), half_a_cell_off(pose, 5)
    found = [aligned(patch(light, 2.0, seed), start) for seed in range(30)]
    deltas = np.array([se3.delta(pose, each.camera_from_cube) for each in found])
    spread = np.sqrt(np.mean((deltas - deltas.mean(axis=0)) ** 2, axis=0))
    claimed = np.sqrt(np.mean([np.diag(each.covariance) for each in found], axis=0))
    assert (claimed > 0.7 * spread).all()
    assert (claimed < 10 * spread).all()


def test_only_the_asked_faces_are_compared() -> None:
    pose = held(at=(0.004, -0.006, distance_of(5)))
    seen = patch(drawn(CUBE, pose, blank=("right",)))
    found = ALIGNER.align(seen, half_a_cell_off(pose, 6), ("front", "top"))
    assert found is not None
    assert set(found.correlations) == {"front", "top"}
    assert off_px(found, pose) < 0.2


def test_an_even_image_is_like_no_marker() -> None:
    pose = held(at=(0.0, 0.0, distance_of(5)))
    random = np.random.default_rng(1)
    nothing = Patch((120 + random.normal(0, 2, (240, 320))).astype(np.float32), 0, 0)
    found = ALIGNER.align(nothing, pose)
    assert found is None or max(found.correlations.values()) < 0.5


@pytest.mark.parametrize("place", [(2.0, 0, 0.4), (0, 0, -0.4), (0, 0, 0.02)])
def test_no_cube_is_aligned_outside_the_image_or_behind_the_camera(
    place: tuple[float, float, float],
) -> None:
    assert ALIGNER.align(patch(drawn(CUBE, held())), held(at=place)) is None


def test_a_negative_of_the_cube_is_not_the_cube() -> None:
    pose = held(at=(0.0, 0.0, 0.9))
    found = ALIGNER.align(patch(0.85 - drawn(CUBE, pose)), pose)
    assert found is None or max(found.correlations.values()) < 0.5


def bent(light: NDArray[np.float32], pose: Array, bends: tuple[float, float, float]) -> Patch:
    """The light of the front face where its paper is bent so [m], as a camera measures it."""
    frame = pose @ face_frame(CUBE.face("front"))
    height, width = light.shape
    v, u = np.mgrid[:height, :width].reshape(2, -1)
    rays = np.linalg.solve(CAMERA.matrix, np.stack([u, v, np.ones_like(u)]))
    rays = frame[:3, :3].T @ rays
    eye = -frame[:3, :3].T @ frame[:3, 3]
    half = 1.2 * CUBE.marker_size / 2
    met = eye[:, None] - rays * eye[2] / rays[2]
    for _ in range(5):
        x, y = np.clip(met[:2] / half, -1, 1)
        heights = bends @ np.stack([x**2 - 1 / 3, x * y, y**2 - 1 / 3])
        met = eye[:, None] + rays * (heights - eye[2]) / rays[2]
    met[2] = 0
    seen = CAMERA.matrix @ (frame[:3, :3] @ met + frame[:3, 3:])
    x, y = (seen[:2] / seen[2]).astype(np.float32).reshape(2, height, width)
    return patch(np.asarray(cv2.remap(light, x, y, cv2.INTER_CUBIC), np.float32))


@pytest.mark.parametrize("lean", [-0.6, 0.6])
def test_bent_paper_does_not_tell_the_wrong_lean(lean: float) -> None:
    """A dome of 0.8 mm over 36 mm moves the cells as a lean to the other side does."""
    pose = held(lean, 0.1, 0.2, at=(0.01, 0.0, 0.6))
    light = drawn(replace(CUBE, faces=(CUBE.face("front"),)), pose)
    planes = FacePlanes(CUBE)
    mirrored = planes.mirror(pose, planes.names.index("front"))
    for dome in (-0.0008, 0.0008):
        seen = bent(light, pose, (dome, 0.0, dome))
        right, wrong = (ALIGNER.align(seen, start, ("front",)) for start in (pose, mirrored))
        assert right is not None
        assert wrong is not None
        assert not wrong.evidence.clearly_exceeds(right.evidence)
        assert right.evidence.total > wrong.evidence.total
        assert np.allclose(right.bends[0], (dome, 0, dome), atol=0.0003)
        assert se3.angle_between(right.camera_from_cube, pose) < np.deg2rad(1.5)


def test_a_pose_that_bends_paper_as_no_paper_is_bent_is_not_clearly_right() -> None:
    pose = held(0.6, 0.1, 0.2, at=(0.01, 0.0, 0.6))
    light = drawn(replace(CUBE, faces=(CUBE.face("front"),)), pose)
    found = ALIGNER.align(bent(light, pose, (0.004, 0.0, -0.004)), pose, ("front",))
    assert found is not None
    assert not found.evidence.clearly_exceeds(Evidence(np.zeros_like(found.evidence.blocks)))


def test_what_a_slight_bend_says_alone_is_no_proof() -> None:
    pose = held(0.5, 0.1, 0.2, at=(0.01, 0.0, 0.6))
    light = drawn(replace(CUBE, faces=(CUBE.face("front"),)), pose)
    found = ALIGNER.align(bent(light, pose, (0.0006, 0.0, 0.0)), pose, ("front",))
    assert found is not None
    blocks = found.evidence.blocks
    flat = Evidence(np.maximum(blocks, 0))
    assert 0.2 < flat.total - found.evidence.total < 2
    assert not flat.clearly_exceeds(found.evidence)
