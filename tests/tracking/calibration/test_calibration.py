"""Calibration from a cube's corners, with a correct uncertainty."""

from dataclasses import replace

import numpy as np
import pytest

from cubeling.tracking import CubeModel, Intrinsics, TrackingError
from cubeling.tracking.calibration import (
    CubeFinder,
    ViewCoverage,
    ViewSample,
    calibrate,
    camera_vector,
    check_camera,
    measured_cube,
)
from cubeling.tracking.calibration.solver import fit_poses
from cubeling.tracking.geometry import se3
from tests.examples import some
from tests.tracking.calibration.waved import aligned, corner_views, folded_corners

SIZE = (1280, 720)
TRUE = np.array([900.0, 901.5, 646.3, 355.9, -0.11, 0.055, 0.0006, -0.0004, -0.012])
CUBE = CubeModel.load("companion")
TARGET = CubeFinder(CUBE).target(SIZE)


def views_of(seed, count=70, noise=0.12, camera=TRUE, **how):
    random = np.random.default_rng(seed)
    real = folded_corners(CUBE, random)
    return corner_views(CUBE, real, camera, SIZE, random, count, noise, **how), real


@pytest.mark.slow(reason="so small an error needs a hundred views")
@pytest.mark.parametrize("seed", some([0, 1, 2]))
def test_focal_length_to_half_a_percent_and_folds_to_a_fifth_of_a_millimetre(seed):
    views, real = views_of(seed, count=100, noise=0.1)
    found = calibrate(views, TARGET)
    away = found.intrinsics.matrix[0, 0] / TRUE[0] - 1
    assert abs(away) < 0.005
    assert abs(away) < 4 * found.focal_spread, "it is less sure than it says"
    assert found.good
    cube = measured_cube(CUBE, found.plates)
    before = aligned(np.array([face.corners for face in CUBE.faces]), real)
    after = aligned(np.array([face.corners for face in cube.faces]), real)
    assert before.max() > 0.0008
    assert after.max() < 0.0002


@pytest.mark.slow(reason="all views are adjusted together, in four stages")
@pytest.mark.parametrize("focal", some([560.0, 1500.0]))
def test_wide_and_long_lenses_are_found_without_a_hint(focal):
    camera = np.array([focal, focal, *TRUE[2:]])
    views, _ = views_of(3, count=24, camera=camera, near=0.25 * focal / 900)
    found = calibrate(views, TARGET)
    assert abs(found.intrinsics.matrix[0, 0] / focal - 1) < max(0.005, 3 * found.focal_spread)


@pytest.mark.slow(reason="all views are adjusted together, in four stages")
def test_frontal_views_of_one_side_are_refused():
    views, _ = views_of(4, count=20, tilt=5.0, only_main=True)
    with pytest.raises(TrackingError, match="tilted more, in every direction") as caught:
        calibrate(views, TARGET).check()
    assert "\n" not in str(caught.value)


def test_too_few_views_are_refused():
    views, _ = views_of(5, count=5)
    with pytest.raises(TrackingError, match="5 of 8"):
        calibrate(views, TARGET)


@pytest.mark.slow(reason="all views are adjusted together, in four stages")
def test_outlier_views_are_dropped():
    views, _ = views_of(6, count=24)
    random = np.random.default_rng(0)
    for number in (3, 11, 20):
        spoilt = views[number].pixels + 25 * random.standard_normal(views[number].pixels.shape)
        views[number] = replace(views[number], pixels=spoilt)
    found = calibrate(views, TARGET)
    assert found.views <= 21
    assert abs(found.intrinsics.matrix[0, 0] / TRUE[0] - 1) < 0.005


def test_derivatives_match_finite_differences():
    views, _ = views_of(7, count=8)
    model, kept = fit_poses(views, TRUE, TARGET)
    blooming = [replace(view, bloom=np.full(len(view.bloom), 0.7)) for view in kept]
    at_rest, camera, plate, own = model.linearise(blooming)
    small = 1e-6
    for number in range(9):
        shared = np.zeros(9 + 6 * len(model.plates))
        shared[number] = small * max(1.0, abs(TRUE[number]))
        moved = model.apply_step(shared, np.zeros((len(kept), 7)))
        slope = (at_rest - moved.linearise(blooming)[0]) / shared[number]
        np.testing.assert_allclose(camera[:, number], slope, rtol=1e-3, atol=1e-3)
    for number in range(6):
        shared = np.zeros(9 + 6 * len(model.plates))
        shared[9 + number :: 6] = small
        moved = model.apply_step(shared, np.zeros((len(kept), 7)))
        slope = (at_rest - moved.linearise(blooming)[0]) / small
        np.testing.assert_allclose(plate[:, number], slope, rtol=1e-3, atol=0.2)
    for number in range(7):
        step = np.zeros(7)
        step[number] = small
        moved = model.apply_step(np.zeros(9 + 6 * len(model.plates)), np.tile(step, (len(kept), 1)))
        slope = (at_rest - moved.linearise(blooming)[0]) / small
        np.testing.assert_allclose(own[:, number], slope, rtol=1e-3, atol=0.2)


@pytest.mark.slow(reason="all views are adjusted together, in four stages")
@pytest.mark.parametrize(
    ("change", "degraded"),
    some(
        [
            (np.array([2.0, 2.0, 1.0, 1.0, 0, 0, 0, 0, 0]), False),
            (np.array([20.0, 20.0, 0, 0, 0, 0, 0, 0, 0]), True),
            (np.array([0, 0, 0, 0, 0.09, 0, 0, 0, 0]), True),
            (np.zeros(9), False),
        ],
        2,
    ),
)
def test_a_saved_camera_is_ok_until_it_has_changed(change, degraded):
    views, _ = views_of(8, count=30, noise=0.05)
    verdict = check_camera(views, camera_vector.to_intrinsics(TRUE + change, SIZE), TARGET)
    assert verdict.degraded is degraded
    assert verdict.focal_change == pytest.approx(-change[0] / (900 + change[0]), abs=0.004)


@pytest.mark.slow(reason="all views are adjusted together, in four stages")
def test_a_saved_camera_of_the_rational_model_can_be_checked():
    views, _ = views_of(9, count=18, noise=0.05)
    plain = camera_vector.to_intrinsics(TRUE, SIZE)
    eight = np.array([*plain.distortion, 0.0, 0.0, 0.0])
    verdict = check_camera(views, Intrinsics(plain.matrix, eight, SIZE), TARGET)
    assert not verdict.degraded


def test_coverage_requests_tilt_first_until_there_is_enough():
    coverage = ViewCoverage([face.name for face in CUBE.faces])
    square = ViewSample((0.5, 0.5), 0.17, (0.02, 0.01), (0,))
    up = ViewSample((0.1, 0.9), 0.25, (0.05, -0.5), (0, 1))
    assert coverage.kinds_of(square) == {"middle"}
    sides = {f"side {face.name}" for face in CUBE.faces[:2]}
    assert coverage.kinds_of(up) == {"tilt up", "bottom left", "near"} | sides
    assert coverage.next_kind() == "tilt up"
    for _ in range(20):
        coverage.add(square)
    assert coverage.next_kind() == "tilt up"
    for _ in range(3):
        coverage.add(up)
    assert coverage.next_kind() == "tilt left"
    assert not coverage.complete
    assert 0 < coverage.progress < 1


def test_coverage_is_complete_when_nothing_is_missing_and_can_require_more():
    coverage = ViewCoverage(["board"])
    for x in (0.1, 0.5, 0.9):
        for y in (0.1, 0.5, 0.9):
            for tilt in ((0.0, -0.5), (0.0, 0.5), (-0.5, 0.0), (0.5, 0.0)):
                for size in (0.2, 0.5):
                    coverage.add(ViewSample((x, y), size, tilt, (0,)))
    assert coverage.complete
    assert coverage.next_kind() == ""
    coverage.require_more()
    assert coverage.next_kind() == "tilt up"


def test_a_measured_cube_follows_its_plates():
    plates = np.tile(np.eye(4), (6, 1, 1))
    for old, new in zip(CUBE.faces, measured_cube(CUBE, plates).faces, strict=True):
        np.testing.assert_allclose(new.corners, old.corners, atol=1e-15)
    plates[2] = se3.apply_delta(np.eye(4), np.array([0.001, 0, 0, 0, 0, 0]))
    moved = measured_cube(CUBE, plates).faces[2].corners - CUBE.faces[2].corners
    np.testing.assert_allclose(moved, np.tile([0.001, 0, 0], (4, 1)), atol=1e-15)
