"""Where the cube goes on to: exact where it can be, silent where it would invent."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import pytest
from numpy.typing import NDArray

from tests.tracking.drawn import CAMERA, held, off, photograph, scene
from tracking.cube.model import CubeModel
from tracking.geometry import se3
from tracking.geometry.frame import Frame
from tracking.tracker import prediction
from tracking.tracker.prediction import MEMORY, TRUST, Sighting, Track
from tracking.tracker.tracker import CubeTracker

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
    """Remember the poses of a way, as the tracker does."""
    track = Track()
    for time in times:
        pose = pose_at(time)
        velocity, change = track.motion(pose, covariance, time)
        track.add(Sighting(pose, velocity, covariance, time, change))
    return track


def last_of(
    pose_at: Callable[[float], Array], times: tuple[float, ...], covariance: Array
) -> Sighting:
    """Last of them."""
    last = followed(pose_at, times, covariance).last
    assert last is not None
    return last


@dataclass(frozen=True)
class Way:
    """Poses one frame apart."""

    poses: list[Array]

    def at(self, time: float) -> Array:
        return self.poses[round(time * RATE)]


def falling(velocity: Array, acceleration: Array) -> Callable[[float], Array]:
    """A way of constant acceleration, (6,) each; the turn about one axis."""
    return lambda t: se3.moved(START, velocity * t + acceleration * t**2 / 2)


@pytest.mark.parametrize("times", [EVEN, UNEVEN])
def test_constant_acceleration_is_told_exactly_but_for_what_is_not_trusted(
    times: tuple[float, ...],
) -> None:
    velocity = np.array([0.3, -0.2, 0.1, 0.0, 1.0, 0.0])
    acceleration = np.array([2.0, 1.0, -3.0, 0.0, 9.0, 0.0])
    last = last_of(falling(velocity, acceleration), times, EXACT)
    assert np.allclose(last.acceleration, TRUST * acceleration, atol=1e-5)
    lagging = (1 - TRUST) * acceleration * (times[2] - times[1]) / 2
    assert np.allclose(last.velocity, velocity + acceleration * times[2] - lagging, atol=1e-6)


@pytest.mark.parametrize("times", [EVEN, UNEVEN])
def test_constant_velocity_is_told_and_carried_on_exactly(times: tuple[float, ...]) -> None:
    velocity = np.array([0.5, -0.2, 0.1, 1.0, 0.0, 0.0])
    way = falling(velocity, np.zeros(6))
    last = last_of(way, times, EXACT)
    assert np.allclose(last.velocity, velocity, atol=1e-9)
    for ahead in (-0.05, 0.0, 0.05, 0.2):
        expected = prediction.predicted(last, last.timestamp + ahead)
        assert np.allclose(expected, way(last.timestamp + ahead), atol=1e-9)
        assert np.allclose(prediction.velocity_at(last, last.timestamp + ahead), velocity)


def test_a_cube_at_rest_seems_to_move_little_more_than_by_two_noisy_poses() -> None:
    """The parabola without regard to noise would be 1.7 times as noisy as the difference of two."""
    random, covariance = np.random.default_rng(1), np.diag(SPREAD**2)
    velocities = []
    for _ in range(500):
        noisy = [se3.moved(START, random.normal(0, SPREAD)) for _ in range(3)]
        velocities.append(last_of(Way(noisy).at, EVEN, covariance).velocity)
    of_a_difference = np.sqrt(2) * SPREAD * RATE
    assert np.mean(np.std(velocities, axis=0) / of_a_difference) < 1.5
    assert (np.abs(np.mean(velocities, axis=0)) < 0.2 * of_a_difference).all()


def test_noise_is_not_taken_for_acceleration_but_a_hand_is() -> None:
    covariance = np.diag(SPREAD**2)
    pushed = falling(np.zeros(6), np.array([6.0, 0, 0, 0, 0, 0]))
    last = last_of(pushed, EVEN, covariance)
    assert last.acceleration[0] == pytest.approx(TRUST * 6.0, rel=0.02)
    slight = SPREAD * RATE**2 / 4
    last = last_of(falling(np.zeros(6), slight), EVEN, covariance)
    assert (np.abs(last.acceleration) < 0.05 * slight).all()


def test_after_a_pause_the_way_is_not_known() -> None:
    track = followed(falling(np.full(6, 0.3), np.zeros(6)), EVEN, EXACT)
    away = se3.moved(START, np.full(6, 0.1))
    just, late = (EVEN[2] + MEMORY * share for share in (0.99, 1.01))
    assert np.linalg.norm(track.motion(away, EXACT, just)[0]) > 0.1
    for each in track.motion(away, EXACT, late):
        assert np.array_equal(each, np.zeros(6))
    assert track.recent(just) is not None
    assert track.recent(late) is None
    assert track.last is not None


def test_one_pose_has_no_velocity_two_have_their_difference() -> None:
    velocity = np.array([0.2, 0.1, 0, 0, 0, 2.0])
    for count, share in ((1, 0.0), (2, 1.0)):
        track = followed(falling(velocity, np.zeros(6)), EVEN[:count], EXACT)
        assert track.last is not None
        assert np.allclose(track.last.velocity, share * velocity, atol=1e-9)
        assert np.array_equal(track.last.acceleration, np.zeros(6))


def test_the_same_time_again_keeps_the_velocity() -> None:
    """A camera may give two frames one timestamp."""
    track = followed(falling(np.full(6, 0.3), np.full(6, 2.0)), EVEN, EXACT)
    assert track.last is not None
    velocity, change = track.motion(START, EXACT, EVEN[2])
    assert np.array_equal(velocity, track.last.velocity)
    assert np.array_equal(change, track.last.acceleration)


def test_fifty_milliseconds_of_a_hand_are_foretold_better_than_by_a_steady_velocity() -> None:
    """To and fro once a second, 0.5 m/s at the fastest, with the noise of tracked poses."""
    random, covariance = np.random.default_rng(2), np.diag(SPREAD**2)
    reach = 0.5 / (2 * np.pi)

    def way(time: float) -> Array:
        return se3.moved(START, reach * np.sin(2 * np.pi * time) * np.eye(6)[0])

    ahead, track = 0.05, Track()
    errors: dict[str, list[float]] = {"held": [], "steady": [], "predicted": []}
    for time in np.arange(90) / RATE:
        pose = se3.moved(way(time), random.normal(0, SPREAD))
        before = track.last
        velocity, change = track.motion(pose, covariance, time)
        track.add(Sighting(pose, velocity, covariance, time, change))
        if before is None or time < 3 / RATE:
            continue
        assert track.last is not None
        step = se3.motion(before.camera_from_cube, pose) * RATE * ahead
        for name, guess in (
            ("held", pose),
            ("steady", se3.moved(pose, step)),
            ("predicted", prediction.predicted(track.last, time + ahead)),
        ):
            errors[name].append(off(guess, way(time + ahead))[0])
    held_, steady, foretold = (float(np.median(each)) for each in errors.values())
    assert 15 < held_ < 20
    assert 4 < steady < 7
    assert foretold < 2
    assert np.percentile(errors["predicted"], 95) < 3


def test_doubt_grows_with_the_time_since_the_cube_was_seen() -> None:
    last = last_of(falling(np.full(6, 0.1), np.zeros(6)), EVEN, np.diag(SPREAD**2))
    doubts = [
        np.linalg.eigvalsh(prediction.predicted_covariance(last, last.timestamp + ahead))
        for ahead in (0.0, 0.03, 0.1, 0.2)
    ]
    assert np.allclose(doubts[0], np.sort(SPREAD**2))
    assert (np.diff(doubts, axis=0) > 0).all()


CUBE = CubeModel.load("locomotion")
SPEED = np.array([0.3, 0, 0, 0, 0, 0])


@pytest.fixture(scope="module")
def tracker() -> CubeTracker:
    """A tracker that has seen a cube move to the right in three frames."""
    tracker = CubeTracker(CUBE, CAMERA)
    for number in range(3):
        pose = se3.moved(START, SPEED * number / RATE)
        picture = photograph(scene((CUBE, pose)), seed=number)
        assert tracker.update(Frame(picture, number / RATE, number)).visible
    return tracker


def test_a_prediction_for_the_last_frame_is_what_was_seen(tracker: CubeTracker) -> None:
    again = CubeTracker(CUBE, CAMERA)
    state = again.update(Frame(photograph(scene((CUBE, START))), 1.0, 0))
    foretold = again.predict(1.0)
    assert state.camera_from_cube is not None
    assert foretold.camera_from_cube is not None
    assert np.allclose(foretold.camera_from_cube, state.camera_from_cube, atol=1e-12)
    assert np.allclose(foretold.covariance, state.covariance)
    assert (foretold.visible, foretold.source, foretold.faces) == (False, "predicted", ())
    assert (foretold.refused, foretold.timestamp) == ("", 1.0)


def test_the_tracker_foretells_a_steady_motion(tracker: CubeTracker) -> None:
    for ahead in (0.0, 1 / 60, 0.05, 0.15):
        time = 2 / RATE + ahead
        foretold = tracker.predict(time)
        millimetres, degrees = off(foretold.camera_from_cube, se3.moved(START, SPEED * time))
        assert millimetres < 0.1 + 12 * ahead
        assert degrees < 0.1 + 3 * ahead
        assert foretold.velocity[0] == pytest.approx(0.3, rel=0.05)
        assert foretold.refused == ""


def test_the_tracker_does_not_foretell_beyond_its_memory(tracker: CubeTracker) -> None:
    gone = tracker.predict(2 / RATE + MEMORY + 0.01)
    assert gone.camera_from_cube is None
    assert np.array_equal(gone.velocity, np.zeros(6))
    assert np.isnan(gone.covariance).all()
    assert CubeTracker(CUBE, CAMERA).predict(0.0).camera_from_cube is None


def test_foretelling_changes_nothing(tracker: CubeTracker) -> None:
    before = repr(tracker.predict(0.1))
    for time in (0.08, 5.0, 0.2):
        tracker.predict(time)
    assert repr(tracker.predict(0.1)) == before
