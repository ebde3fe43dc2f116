"""The prediction is exact where it can be, and absent where it would be a guess."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import pytest
from numpy.typing import NDArray

from cubeling.tracking.cube.model import CubeModel
from cubeling.tracking.geometry import se3
from cubeling.tracking.geometry.frame import Frame
from cubeling.tracking.tracker.prediction import (
    MAX_ACCELERATION_SHARE,
    MAX_PREDICTION_S,
    Prediction,
    Track,
    TrackedPose,
)
from cubeling.tracking.tracker.tracker import CubeTracker
from tests.tracking.drawn import CAMERA, held, off, photograph, scene

Array = NDArray[np.float64]

RATE = 30.0
START = held()
EXACT = np.eye(6) * 1e-16
SPREAD = np.array([2e-5, 2e-5, 1e-4, 3e-4, 3e-4, 3e-4])
"""Noise of a tracked cube [m, rad]."""

EVEN, UNEVEN = (0.0, 1 / 30, 2 / 30), (0.0, 0.021, 0.088)


def followed(
    pose_at: Callable[[float], Array], times: tuple[float, ...], covariance: Array
) -> Track:
    """Track a moving pose, as the tracker does."""
    track = Track()
    for time in times:
        pose = pose_at(time)
        velocity, acceleration = track.motion(pose, covariance, time)
        track = track.add(TrackedPose(pose, velocity, covariance, time, acceleration))
    return track


def last_of(
    pose_at: Callable[[float], Array], times: tuple[float, ...], covariance: Array
) -> TrackedPose:
    """The last pose of that track."""
    return followed(pose_at, times, covariance).poses[-1]


def predict(track: Track, timestamp: float) -> Prediction:
    prediction = track.predict(timestamp)
    assert prediction is not None
    return prediction


@dataclass(frozen=True)
class Way:
    """Poses one frame apart."""

    poses: list[Array]

    def at(self, time: float) -> Array:
        return self.poses[round(time * RATE)]


def falling(velocity: Array, acceleration: Array) -> Callable[[float], Array]:
    """A motion of constant acceleration, (6,) each; the rotation about one axis."""
    return lambda t: se3.apply_delta(START, velocity * t + acceleration * t**2 / 2)


@pytest.mark.parametrize("times", [EVEN, UNEVEN])
def test_constant_acceleration_is_estimated_up_to_the_trusted_share(
    times: tuple[float, ...],
) -> None:
    velocity = np.array([0.3, -0.2, 0.1, 0.0, 1.0, 0.0])
    acceleration = np.array([2.0, 1.0, -3.0, 0.0, 9.0, 0.0])
    last = last_of(falling(velocity, acceleration), times, EXACT)
    assert np.allclose(last.acceleration, MAX_ACCELERATION_SHARE * acceleration, atol=1e-5)
    lagging = (1 - MAX_ACCELERATION_SHARE) * acceleration * (times[2] - times[1]) / 2
    assert np.allclose(last.velocity, velocity + acceleration * times[2] - lagging, atol=1e-6)


@pytest.mark.parametrize("times", [EVEN, UNEVEN])
def test_constant_velocity_is_estimated_and_extrapolated_exactly(times: tuple[float, ...]) -> None:
    velocity = np.array([0.5, -0.2, 0.1, 1.0, 0.0, 0.0])
    way = falling(velocity, np.zeros(6))
    track = followed(way, times, EXACT)
    assert np.allclose(track.poses[-1].velocity, velocity, atol=1e-9)
    for ahead in (0.0, 0.05, 0.199):
        expected = predict(track, times[-1] + ahead)
        assert np.allclose(expected.camera_from_cube, way(times[-1] + ahead), atol=1e-9)
        assert np.allclose(expected.velocity, velocity)


def test_the_velocity_at_rest_is_hardly_noisier_than_a_difference_of_two_poses() -> None:
    """The parabola without regard to noise would be 1.7 times as noisy as the difference of two."""
    random, covariance = np.random.default_rng(1), np.diag(SPREAD**2)
    velocities = []
    for _ in range(500):
        noisy = [se3.apply_delta(START, random.normal(0, SPREAD)) for _ in range(3)]
        velocities.append(last_of(Way(noisy).at, EVEN, covariance).velocity)
    of_a_difference = np.sqrt(2) * SPREAD * RATE
    assert np.mean(np.std(velocities, axis=0) / of_a_difference) < 1.5
    assert (np.abs(np.mean(velocities, axis=0)) < 0.2 * of_a_difference).all()


def test_noise_is_not_taken_for_acceleration_but_a_push_is() -> None:
    covariance = np.diag(SPREAD**2)
    pushed = falling(np.zeros(6), np.array([6.0, 0, 0, 0, 0, 0]))
    last = last_of(pushed, EVEN, covariance)
    assert last.acceleration[0] == pytest.approx(MAX_ACCELERATION_SHARE * 6.0, rel=0.02)
    slight = SPREAD * RATE**2 / 4
    last = last_of(falling(np.zeros(6), slight), EVEN, covariance)
    assert (np.abs(last.acceleration) < 0.05 * slight).all()


def test_after_a_pause_there_is_no_velocity_and_no_prediction() -> None:
    track = followed(falling(np.full(6, 0.3), np.zeros(6)), EVEN, EXACT)
    away = se3.apply_delta(START, np.full(6, 0.1))
    just, late = (EVEN[2] + MAX_PREDICTION_S * share for share in (0.99, 1.01))
    assert np.linalg.norm(track.motion(away, EXACT, just)[0]) > 0.1
    for each in track.motion(away, EXACT, late):
        assert np.array_equal(each, np.zeros(6))
    assert track.predict(just) is not None
    assert track.predict(late) is None


def test_one_pose_has_no_velocity_two_have_their_difference() -> None:
    velocity = np.array([0.2, 0.1, 0, 0, 0, 2.0])
    for count, share in ((1, 0.0), (2, 1.0)):
        track = followed(falling(velocity, np.zeros(6)), EVEN[:count], EXACT)
        assert np.allclose(track.poses[-1].velocity, share * velocity, atol=1e-9)
        assert np.array_equal(track.poses[-1].acceleration, np.zeros(6))


def test_the_same_time_again_keeps_the_velocity() -> None:
    """A camera may give two frames one timestamp."""
    track = followed(falling(np.full(6, 0.3), np.full(6, 2.0)), EVEN, EXACT)
    velocity, acceleration = track.motion(START, EXACT, EVEN[2])
    assert np.array_equal(velocity, track.poses[-1].velocity)
    assert np.array_equal(acceleration, track.poses[-1].acceleration)


def test_fifty_milliseconds_ahead_are_predicted_better_than_at_constant_velocity() -> None:
    """To and fro once a second, 0.5 m/s at the fastest, with the noise of tracked poses."""
    random, covariance = np.random.default_rng(2), np.diag(SPREAD**2)
    reach = 0.5 / (2 * np.pi)

    def way(time: float) -> Array:
        return se3.apply_delta(START, reach * np.sin(2 * np.pi * time) * np.eye(6)[0])

    ahead, track = 0.05, Track()
    errors: dict[str, list[float]] = {"held": [], "steady": [], "predicted": []}
    for time in np.arange(90) / RATE:
        pose = se3.apply_delta(way(time), random.normal(0, SPREAD))
        before = track.poses[-1] if track.poses else None
        velocity, acceleration = track.motion(pose, covariance, time)
        track = track.add(TrackedPose(pose, velocity, covariance, time, acceleration))
        if before is None or time < 3 / RATE:
            continue
        step = se3.delta(before.camera_from_cube, pose) * RATE * ahead
        for name, guess in (
            ("held", pose),
            ("steady", se3.apply_delta(pose, step)),
            ("predicted", predict(track, time + ahead).camera_from_cube),
        ):
            errors[name].append(off(guess, way(time + ahead))[0])
    held_, steady, with_track = (float(np.median(each)) for each in errors.values())
    assert 15 < held_ < 20
    assert 4 < steady < 7
    assert with_track < 2
    assert np.percentile(errors["predicted"], 95) < 3


def test_the_covariance_grows_with_the_time_since_the_last_pose() -> None:
    track = followed(falling(np.full(6, 0.1), np.zeros(6)), EVEN, np.diag(SPREAD**2))
    variances = [
        np.linalg.eigvalsh(predict(track, EVEN[-1] + ahead).covariance)
        for ahead in (0.0, 0.03, 0.1, 0.199)
    ]
    assert np.allclose(variances[0], np.sort(SPREAD**2))
    assert (np.diff(variances, axis=0) > 0).all()


CUBE = CubeModel.load("locomotion")
SPEED = np.array([0.3, 0, 0, 0, 0, 0])


@pytest.fixture(scope="module")
def tracker() -> CubeTracker:
    """A tracker that has seen a cube move to the right in three frames."""
    tracker = CubeTracker(CUBE, CAMERA)
    for number in range(3):
        pose = se3.apply_delta(START, SPEED * number / RATE)
        picture = photograph(scene((CUBE, pose)), seed=number)
        assert tracker.update(Frame(picture, number / RATE, number)).visible
    return tracker


def test_a_prediction_for_the_last_frame_is_its_pose(tracker: CubeTracker) -> None:
    again = CubeTracker(CUBE, CAMERA)
    state = again.update(Frame(photograph(scene((CUBE, START))), 1.0, 0))
    predicted = again.predict(1.0)
    assert state.camera_from_cube is not None
    assert predicted.camera_from_cube is not None
    assert np.allclose(predicted.camera_from_cube, state.camera_from_cube, atol=1e-12)
    assert np.allclose(predicted.covariance, state.covariance)
    assert (predicted.visible, predicted.source, predicted.faces) == (False, "predicted", ())
    assert (predicted.refused, predicted.timestamp) == ("", 1.0)


def test_the_tracker_predicts_a_steady_motion(tracker: CubeTracker) -> None:
    for ahead in (0.0, 1 / 60, 0.05, 0.15):
        time = 2 / RATE + ahead
        predicted = tracker.predict(time)
        millimetres, degrees = off(predicted.camera_from_cube, se3.apply_delta(START, SPEED * time))
        assert millimetres < 0.1 + 12 * ahead
        assert degrees < 0.1 + 3 * ahead
        assert predicted.velocity[0] == pytest.approx(0.3, rel=0.05)
        assert predicted.refused == ""


def test_the_tracker_predicts_no_longer_than_it_may(tracker: CubeTracker) -> None:
    gone = tracker.predict(2 / RATE + MAX_PREDICTION_S + 0.01)
    assert gone.camera_from_cube is None
    assert np.array_equal(gone.velocity, np.zeros(6))
    assert np.isnan(gone.covariance).all()
    assert CubeTracker(CUBE, CAMERA).predict(0.0).camera_from_cube is None


def test_predicting_changes_nothing(tracker: CubeTracker) -> None:
    before = repr(tracker.predict(0.1))
    for time in (0.08, 5.0, 0.2):
        tracker.predict(time)
    assert repr(tracker.predict(0.1)) == before


@pytest.mark.parametrize("ahead", [0.03, 0.1, 0.19])
def test_the_predicted_velocity_is_that_of_the_predicted_poses(ahead: float) -> None:
    start = TrackedPose(START, np.zeros(6), EXACT, 0.0, np.array([8.0, 0, 0, 0, 20.0, 0]))
    track = Track((start,))
    before, after = (predict(track, ahead + step) for step in (-1e-5, 1e-5))
    moved = se3.delta(before.camera_from_cube, after.camera_from_cube) / 2e-5
    np.testing.assert_allclose(predict(track, ahead).velocity, moved, atol=1e-3)
