"""Following a loop on the table."""

import numpy as np
import pytest
from hypothesis import given, strategies as st

from cubeling.characters import ClosedPath

SQUARE = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
EIGHT = np.array([[0.0, 0.0], [1.0, 1.0], [1.0, 0.0], [0.0, 1.0]])


@given(st.floats(-10, 10), st.integers(-3, 3))
def test_points_repeat_every_round(along, rounds):
    path = ClosedPath(SQUARE)
    assert path.at(along) == pytest.approx(path.at(along + rounds * path.length), abs=1e-9)


@pytest.mark.parametrize("points", [SQUARE, EIGHT])
def test_following_the_look_ahead_point_walks_the_whole_loop_in_order(points):
    path = ClosedPath(points)
    position = points[0].copy()
    visited: list[int] = []
    for _ in range(2000):
        target = path.ahead(position, 0.1)
        step = target - position
        position += 0.01 * step / max(float(np.linalg.norm(step)), 1e-9)
        corner = int(np.argmin(np.linalg.norm(points - position, axis=1)))
        near = np.linalg.norm(points[corner] - position) < 0.12
        if near and (not visited or visited[-1] != corner):
            visited.append(corner)
    assert visited[:8] == [0, 1, 2, 3, 0, 1, 2, 3]


def test_the_look_ahead_point_is_at_the_look_ahead_distance():
    path = ClosedPath(SQUARE)
    target = path.ahead(np.array([0.5, -0.02]), 0.1)
    assert np.linalg.norm(target - [0.5, -0.02]) == pytest.approx(0.1, abs=0.01)


def test_a_path_shorter_than_the_look_ahead_distance_is_followed():
    assert np.isfinite(ClosedPath(SQUARE * 0.001).ahead(np.zeros(2), 0.1)).all()


def test_a_path_without_length_is_refused():
    with pytest.raises(ValueError, match="two different"):
        ClosedPath(np.zeros((3, 2)))
