"""A cube shown all over the picture tells how the lens bends it; an honest lens is believed."""

import functools
from collections.abc import Iterator
from dataclasses import replace

import cv2
import numpy as np
import pytest
from numpy.typing import NDArray

from cubeling.tracking.cube.model import CubeModel
from cubeling.tracking.geometry import se3
from cubeling.tracking.geometry.frame import Frame
from cubeling.tracking.geometry.image_region import Patch
from cubeling.tracking.geometry.projection import Projection
from cubeling.tracking.refinement.edges.edge_refinement import EdgeRefiner
from cubeling.tracking.refinement.lens_estimate import LensEstimate, LensEstimator
from cubeling.tracking.refinement.systematic_error import CLAIMED_K1, MEASURED_K1, SystematicError
from cubeling.tracking.tracker.tracker import CubeTracker
from tests.examples import some
from tests.tracking.drawn import CAMERA, held, photograph, scene

CUBE = CubeModel.load("locomotion")
K1 = 0.13


def bent(picture: NDArray[np.float32], k1: float) -> NDArray[np.float32]:
    """What a lens with this k1 shows of a pinhole's picture."""
    lens = np.array([k1, 0, 0, 0, 0])
    columns, rows = np.meshgrid(*(np.arange(size, dtype=np.float64) for size in CAMERA.size))
    pixels = np.stack([columns, rows], axis=-1).reshape(-1, 1, 2)
    straight = cv2.undistortPoints(pixels, CAMERA.matrix, lens, None, None, CAMERA.matrix)
    places = straight.reshape(*columns.shape, 2).astype(np.float32)
    return np.asarray(
        cv2.remap(picture, places, np.empty(0, np.float32), cv2.INTER_CUBIC), np.float32
    )


@functools.lru_cache(2)
def drawn(k1: float, count: int) -> tuple[tuple[NDArray[np.float64], NDArray[np.uint8]], ...]:
    """Poses and pictures of a cube at rest in many places."""
    random, shown = np.random.default_rng(3), []
    for index in range(count):
        turn = random.uniform((0.4, 0.4, -0.5), (0.8, 0.8, 0.5))
        depth = float(random.uniform(0.3, 0.45))
        sides = depth * random.uniform(-1, 1, 2) * (0.36, 0.24)
        x, y, z = turn.tolist()
        pose = held(x, y, z, at=(float(sides[0]), float(sides[1]), depth))
        picture = photograph(bent(scene((CUBE, pose)), k1), seed=index)
        picture.setflags(write=False)
        shown.append((pose, picture))
    return tuple(shown)


def frames(k1: float, count: int) -> Iterator[Frame]:
    """Show each picture twice, so that the second one is followed."""
    for index, (_, picture) in enumerate(drawn(k1, count)):
        for again in range(2):
            yield Frame(picture, 2.0 * index + again / 30, 2 * index + again)


def watched(claimed: float, k1: float, count: int = 30) -> CubeTracker:
    """Return a tracker that was told of a k1 and has seen frames with another."""
    tracker = CubeTracker(CUBE, replace(CAMERA, distortion=np.array([claimed, 0, 0, 0, 0])))
    for frame in frames(k1, count):
        tracker.update(frame)
    return tracker


@pytest.mark.slow(reason="a lens is known after some thirty places")
@pytest.mark.parametrize("k1", some([K1, -0.1]))
def test_a_lens_that_claims_zero_is_measured_in_play(k1: float) -> None:
    lens = watched(0.0, k1).lens
    assert abs(lens.k1 - k1) < 2 * lens.deviation
    assert lens.off


@pytest.mark.full
@pytest.mark.slow(reason="pictures are drawn and bent")
def test_a_lens_that_may_bend_costs_nothing_where_it_does_not() -> None:
    """Beside one that is known to be straight; where the lens bends, the doubt helps."""
    assert median_error(0.0, 0.0) < 1.15 * median_error(1e-6, 0.0)
    assert median_error(0.0, K1) < 0.5 * median_error(1e-6, K1)


def median_error(claimed: float, k1: float) -> float:
    """How far edges are off in frames that are followed, through such a lens [m]."""
    lens = replace(CAMERA, distortion=np.array([claimed, 0, 0, 0, 0]))
    refiner, errors = EdgeRefiner(CUBE, Projection(lens)), []
    for pose, picture in drawn(k1, 10):
        found = refiner.refine(Patch.crop(picture), pose)
        assert found is not None
        errors.append(np.linalg.norm(se3.delta(found.camera_from_cube, pose)[:3]))
    return float(np.median(errors))


@pytest.mark.full
@pytest.mark.slow(reason="a lens is known after some thirty places")
@pytest.mark.parametrize("k1", some([K1, 0.0]))
def test_an_honest_lens_is_believed(k1: float) -> None:
    lens = watched(k1, k1).lens
    assert abs(lens.k1) < 2 * lens.deviation
    assert lens.known
    assert not lens.off


def test_a_cube_at_rest_counts_once() -> None:
    tracker, still = CubeTracker(CUBE, CAMERA), next(frames(K1, 1))
    deviations = set()
    for index in range(8):
        tracker.update(replace(still, timestamp=index / 30, index=index))
        deviations.add(tracker.lens.deviation)
    assert len(deviations) == 2  # before and after
    assert not tracker.lens.known


def test_what_was_measured_replaces_what_is_assumed_of_a_lens() -> None:
    claimed, measured = (
        LensEstimator([CUBE], Projection(replace(CAMERA, distortion=np.array([k1, 0, 0, 0, 0]))))
        for k1 in (0.0, K1)
    )
    assert (claimed.k1_error, measured.k1_error) == (CLAIMED_K1, MEASURED_K1)
    for estimator in (claimed, measured):
        estimator.estimate = LensEstimate(0.03, 0.04)
    assert (claimed.k1_error, measured.k1_error) == (CLAIMED_K1, MEASURED_K1)
    for estimator in (claimed, measured):
        estimator.estimate = LensEstimate(0.03, 0.02)
    assert claimed.k1_error == pytest.approx(np.hypot(0.03, 0.02))
    assert measured.k1_error == MEASURED_K1
    for estimator in (claimed, measured):
        estimator.estimate = LensEstimate(0.12, 0.02)
        assert estimator.k1_error == pytest.approx(np.hypot(0.12, 0.02))


def test_a_lens_that_is_known_leaves_less_doubt_of_a_pose() -> None:
    error, pose = SystematicError(CUBE, Projection(CAMERA)), held(at=(0.1, 0.05, 0.4))
    before, after = (
        corners + moves @ moves.T
        for corners, moves in (error.covariance(pose, ("front", "top"), k1) for k1 in (0.1, 0.02))
    )
    assert np.trace(after[:2, :2]) < np.trace(before[:2, :2]) / 2
