"""A cube at rest is averaged; one that moves is not, and has no lag."""

import numpy as np
import pytest
from hypothesis import given, strategies as st

from cubeling.tracking.geometry import se3
from cubeling.tracking.tracker.rest import MAX_FRAME_GAP_S, MAX_REST_FRAMES, Rest

DEVIATIONS = np.array([4e-5, 3e-5, 2e-4, 1e-3, 1e-3, 2e-4])
NOISE = np.diag(DEVIATIONS**2)
START = se3.pose(se3.rotation(np.array([0.4, -0.2, 0.1])), np.array([0.02, 0.01, 0.5]))
RATE = 30.0


def means(deltas):
    """The stated pose deltas of a cube whose poses are `deltas` from START."""
    rest, stated = Rest(), []
    for index, delta in enumerate(deltas):
        rest = rest.add(se3.apply_delta(START, delta), NOISE, index / RATE)
        stated.append(se3.delta(START, rest.pose()[0]))
    return np.array(stated)


def noise(seed, count):
    return np.random.default_rng(seed).normal(size=(count, 6)) * DEVIATIONS


def test_a_cube_at_rest_jitters_less():
    stated = means(noise(1, 600))
    assert (stated[MAX_REST_FRAMES:].std(axis=0) < 0.7 * DEVIATIONS).all()


def test_the_covariance_falls_with_the_number_of_frames():
    rest = Rest()
    for index in range(3):
        rest = rest.add(START, NOISE, index / RATE)
        np.testing.assert_allclose(rest.pose()[1], NOISE / (index + 1))


@given(seed=st.integers(0, 1000), axis=st.integers(0, 5), sign=st.sampled_from((-1, 1)))
def test_a_jump_of_nine_deviations_is_stated_at_once(seed, axis, sign):
    deltas = noise(seed, 20)
    deltas[15:, axis] += sign * 9 * DEVIATIONS[axis]
    np.testing.assert_allclose(means(deltas)[15], deltas[15], atol=1e-12)


@given(speed=st.floats(0.0, 5.0), axis=st.integers(0, 5))
def test_a_slow_drift_lags_by_less_than_the_noise(speed, axis):
    """`speed` in deviations a frame."""
    deltas = np.zeros((60, 6))
    deltas[:, axis] = speed * DEVIATIONS[axis] * np.arange(60)
    lag = np.abs(means(deltas) - deltas)[:, axis] / DEVIATIONS[axis]
    assert lag.max() < 2.52


def test_a_pause_begins_anew():
    rest = Rest().add(START, NOISE, 0.0)
    later = se3.apply_delta(START, DEVIATIONS)
    pose, covariance = rest.add(later, NOISE, MAX_FRAME_GAP_S + 0.01).pose()
    np.testing.assert_allclose(pose, later)
    np.testing.assert_allclose(covariance, NOISE)


@pytest.mark.parametrize("step", [0.0, -0.1])
def test_a_clock_that_stands_still_or_runs_back_begins_anew(step):
    later = se3.apply_delta(START, DEVIATIONS)
    pose, _ = Rest().add(START, NOISE, 1.0).add(later, NOISE, 1.0 + step).pose()
    np.testing.assert_allclose(pose, later)
