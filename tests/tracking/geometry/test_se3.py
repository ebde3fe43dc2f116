"""Rigid transforms are exact for every rotation, also near zero and near π."""

import numpy as np
import pytest
from hypothesis import given, strategies as st
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from cubeling.tracking.geometry import se3
from cubeling.tracking.gestures.gestures import TurnCounter, wrap_angle

Array = NDArray[np.float64]

coordinates = st.floats(-1, 1, allow_subnormal=False)
directions = (
    st.tuples(coordinates, coordinates, coordinates)
    .map(np.array)
    .filter(lambda v: np.linalg.norm(v) > 1e-3)
)
angles = st.one_of(st.floats(0, np.pi - 1e-4), st.sampled_from([0.0, 1e-9, 1e-7, 1e-5, 3.1414]))


def vector(direction: Array, angle: float) -> Array:
    return direction / np.linalg.norm(direction) * angle


@given(directions, angles)
def test_rotation_agrees_with_scipy(direction: Array, angle: float) -> None:
    expected = Rotation.from_rotvec(vector(direction, angle)).as_matrix()
    assert np.allclose(se3.rotation(vector(direction, angle)), expected, atol=1e-12)


@given(directions, angles)
def test_the_logarithm_undoes_the_exponential(direction: Array, angle: float) -> None:
    turn = vector(direction, angle)
    assert np.allclose(se3.rotation_vector(se3.rotation(turn)), turn, atol=1e-9)


@given(directions)
def test_half_a_turn_has_an_axis(direction: Array) -> None:
    axis = vector(direction, 1)
    found = se3.rotation_vector(se3.rotation(axis * np.pi))
    assert np.linalg.norm(found) == pytest.approx(np.pi)
    assert abs(found @ axis) == pytest.approx(np.pi)


@given(directions, angles, directions, directions, angles)
def test_delta_is_the_inverse_of_moved(
    first: Array, angle: float, shift: Array, second: Array, other: float
) -> None:
    start = se3.pose(se3.rotation(vector(first, angle)), shift)
    step = np.concatenate([shift * 2, vector(second, other)])
    end = se3.apply_delta(start, step)
    assert np.allclose(se3.apply_delta(start, se3.delta(start, end)), end, atol=1e-9)
    assert np.allclose(se3.inverse(start) @ start, np.eye(4), atol=1e-12)


@given(st.lists(st.tuples(directions, angles), min_size=1, max_size=4))
def test_deltas_of_several_poses_are_those_of_each(turns: list[tuple[Array, float]]) -> None:
    start = se3.pose(se3.rotation(np.array([0.3, -0.2, 0.1])), np.array([0.1, 0.2, 0.5]))
    ends = np.stack(
        [se3.apply_delta(start, np.append(place, vector(place, a))) for place, a in turns]
    )
    expected = [se3.delta(start, end) for end in ends]
    assert np.allclose(se3.deltas(start, ends), expected, atol=1e-12)


@pytest.mark.parametrize("angle", [0.0, 1e-9, 1e-7, 1e-5, 0.5])
def test_deltas_are_exact_near_zero(angle: float) -> None:
    ends = np.stack([se3.apply_delta(np.eye(4), np.array([0, 0, 0, angle, 0, 0]))] * 2)
    assert np.allclose(se3.deltas(np.eye(4), ends)[:, 3], angle, rtol=1e-9, atol=1e-16)


@given(st.floats(-1e3, 1e3))
def test_wrapping_keeps_the_direction(angle: float) -> None:
    assert -np.pi <= wrap_angle(angle) <= np.pi
    assert np.cos(wrap_angle(angle)) == pytest.approx(np.cos(angle), abs=1e-9)
    assert np.sin(wrap_angle(angle)) == pytest.approx(np.sin(angle), abs=1e-9)


@given(st.floats(-10, 10), st.lists(st.floats(-3.1, 3.1), min_size=1, max_size=50))
def test_turns_add_up_along_any_path(start: float, steps: list[float]) -> None:
    counter = TurnCounter()
    counter.restart(wrap_angle(start))
    angle = start
    for step in steps:
        angle += step
        counter.add(wrap_angle(angle))
    assert counter.turns == pytest.approx(sum(steps) / (2 * np.pi), abs=1e-9)


def test_a_counter_without_a_start_counts_nothing() -> None:
    counter = TurnCounter()
    counter.add(1.0)
    assert counter.turns == 0.0
