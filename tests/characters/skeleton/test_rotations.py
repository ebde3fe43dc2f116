import numpy as np
import pytest
from hypothesis import assume, given, strategies as st
from hypothesis.extra.numpy import arrays
from scipy.spatial.transform import Rotation

from cubeling.characters.skeleton import rotations

numbers = st.floats(-1, 1)
quaternions = (
    arrays(float, (3, 4), elements=numbers)
    .filter(lambda q: np.linalg.norm(q, axis=1).min() > 0.1)
    .map(lambda q: q / np.linalg.norm(q, axis=1, keepdims=True))
)
vectors = arrays(float, (3, 3), elements=st.floats(-3, 3))


def same(a, b):
    return np.allclose(rotations.align(a, b), b, atol=1e-7)


@given(quaternions, quaternions)
def test_products_and_matrices_agree_with_scipy(a, b):
    product = Rotation.from_quat(a) * Rotation.from_quat(b)
    assert same(rotations.multiply(a, b), product.as_quat())
    assert np.allclose(rotations.to_matrix(a), Rotation.from_quat(a).as_matrix(), atol=1e-12)


@given(quaternions)
def test_a_matrix_gives_back_its_quaternion(q):
    assert same(rotations.from_matrix(rotations.to_matrix(q)), q)


@given(quaternions)
def test_logarithm_and_exponential_are_inverse(q):
    vector = rotations.to_rotation_vector(q)
    assert np.allclose(vector, Rotation.from_quat(q).as_rotvec(), atol=1e-6) or np.allclose(
        np.linalg.norm(vector, axis=1).max(), np.pi, atol=1e-5
    )
    assert same(rotations.from_rotation_vector(vector), q)


@given(quaternions, vectors)
def test_rotation_keeps_lengths_and_the_conjugate_is_its_inverse(q, v):
    turned = rotations.rotate(q, v)
    assert np.allclose(np.linalg.norm(turned, axis=1), np.linalg.norm(v, axis=1))
    assert np.allclose(rotations.rotate(rotations.conjugate(q), turned), v)


@given(quaternions, quaternions, st.floats(0, 1))
def test_slerp_has_constant_speed_along_the_shorter_way(a, b, u):
    middle = rotations.slerp(a, b, u)
    whole = np.abs((a * b).sum(1)).clip(0, 1)
    part = np.abs((a * middle).sum(1)).clip(0, 1)
    assert np.allclose(np.arccos(part), u * np.arccos(whole), atol=1e-5)


@given(quaternions, quaternions)
def test_mixes_do_not_depend_on_quaternion_signs(a, b):
    assume(np.abs((a * b).sum(1)).min() > 1e-6)  # half a turn apart, both ways are the shorter one
    assert same(rotations.nlerp(a, b, 0.4), rotations.nlerp(a, -b, 0.4))
    assert same(rotations.slerp(a, b, 0.4), rotations.slerp(a, -b, 0.4))


@given(vectors, vectors)
def test_the_shortest_arc_takes_one_direction_to_the_other(start, end):
    start, end = start + np.array([4, 0, 0]), end + np.array([0, 4, 0])
    turned = rotations.rotate(rotations.between(start, end), start)
    lengths = np.linalg.norm(start, axis=1, keepdims=True) / np.linalg.norm(
        end, axis=1, keepdims=True
    )
    assert np.allclose(turned, end * lengths, atol=1e-6)


@pytest.mark.parametrize("order", ["xyz", "zyx", "yxz"])
def test_euler_angles_multiply_from_left_to_right(order):
    angles = [0.3, -0.5, 0.9]
    expected = Rotation.from_euler(order.upper(), angles).as_quat()
    assert same(rotations.from_euler(order, angles), expected)


def test_a_continuous_track_has_no_flips():
    spin = rotations.about("y", np.linspace(0, 6 * np.pi, 100))
    broken = spin * np.where(np.arange(100) % 3 == 0, -1, 1)[:, None]
    track = rotations.continuous(broken[:, None])
    assert ((track[1:] * track[:-1]).sum(-1) > 0).all()
    assert same(track[:, 0], spin)
