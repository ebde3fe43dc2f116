"""Several targets at once (S17)."""

import time

import numpy as np
import pytest

from cubeling.characters.errors import CharacterError
from cubeling.characters.ik.solvers.trees import Target, Tree, solve_tree
from cubeling.characters.skeleton import rotations
from cubeling.characters.skeleton.pose import Array

LEFT, RIGHT, FORK = 6, 9, 3


@pytest.fixture(scope="module")
def body() -> Tree:
    """A trunk of three bones with two arms of three bones: a Y."""
    offsets = [
        [0, 0, 0], [0, 0.1, 0], [0, 0.1, 0], [0, 0.1, 0],
        [0.08, 0.05, 0], [0.12, 0, 0], [0.1, 0, 0],
        [-0.08, 0.05, 0], [-0.12, 0, 0], [-0.1, 0, 0],
    ]  # fmt: skip
    return Tree((-1, 0, 1, 2, 3, 4, 5, 3, 7, 8), np.array(offsets))


def rest(count: int) -> Array:
    return np.tile(rotations.IDENTITY, (count, 10, 1))


@pytest.fixture(scope="module")
def posed(body: Tree) -> Array:
    """The points of bodies in random postures, (20, joints, 3)."""
    turns = 0.5 * np.random.default_rng(0).normal(size=(20, 10, 3))
    return body.points(rotations.from_rotation_vector(turns))[1]


def test_both_ends_of_a_y_reach_their_targets(body: Tree, posed: Array) -> None:
    targets = [Target(LEFT, posed[:, LEFT]), Target(RIGHT, posed[:, RIGHT])]
    found = solve_tree(body, targets, rest(20))
    assert found.errors.max() < 1e-3
    _, points = body.points(found.rotations)
    assert np.abs(points - found.positions).max() < 1e-9


def test_a_joint_between_may_have_a_target_too(body: Tree, posed: Array) -> None:
    targets = [Target(joint, posed[:, joint]) for joint in (LEFT, RIGHT, FORK)]
    assert solve_tree(body, targets, rest(20)).errors.max() < 1e-3


def test_errors_of_contradicting_targets_are_inverse_to_their_weights(body: Tree) -> None:
    places = np.array([[[0.3, 0.4, 0.1]], [[0.3, 0.5, 0.1]]])
    targets = [Target(LEFT, places[0], 3.0), Target(LEFT, places[1], 1.0)]
    (errors,) = solve_tree(body, targets, rest(1)).errors
    assert errors[1] / errors[0] == pytest.approx(3.0, rel=0.01)


def test_weighted_errors_of_two_ends_that_pull_apart_are_least(body: Tree) -> None:
    optimize = pytest.importorskip("scipy.optimize")
    places = np.array([[[0.5, 0.2, 0.1]], [[-0.5, 0.15, -0.1]]])
    targets = [Target(LEFT, places[0], 2.0), Target(RIGHT, places[1], 1.0)]

    def residuals(vectors: Array) -> Array:
        _, points = body.points(rotations.from_rotation_vector(vectors.reshape(1, 10, 3)))
        parts = [
            np.sqrt(each.weight) * (points[0, each.joint] - each.places[0]) for each in targets
        ]
        return np.concatenate(parts)

    begin = 0.2 * np.random.default_rng(1).normal(size=30)
    oracle = optimize.least_squares(residuals, begin)
    (errors,) = solve_tree(body, targets, rest(1)).errors
    cost = 0.5 * (2.0 * errors[0] ** 2 + errors[1] ** 2)
    assert cost <= 1.005 * oracle.cost


def test_no_weight_is_no_target(body: Tree, posed: Array) -> None:
    one = solve_tree(body, [Target(LEFT, posed[:, LEFT])], rest(20))
    both = [Target(LEFT, posed[:, LEFT]), Target(RIGHT, posed[:, RIGHT], weight=0.0)]
    assert np.array_equal(solve_tree(body, both, rest(20)).positions, one.positions)


def test_higher_priority_is_reached_whatever_the_others_want(body: Tree) -> None:
    places = np.array([[[0.3, 0.4, 0.1]], [[0.3, 0.5, 0.1]]])
    targets = [Target(LEFT, places[0], priority=1), Target(LEFT, places[1], weight=9.0)]
    (errors,) = solve_tree(body, targets, rest(1)).errors
    assert errors[0] < 1e-3
    assert errors[1] == pytest.approx(0.1, abs=1e-3)


def test_second_target_costs_less_than_two_and_a_half_solves(body: Tree, posed: Array) -> None:
    both = [Target(LEFT, posed[:, LEFT]), Target(RIGHT, posed[:, RIGHT])]
    shortest = []
    for targets in (both[:1], both):
        times = []
        for _ in range(5):
            begin = time.process_time()
            solve_tree(body, targets, rest(20))
            times.append(time.process_time() - begin)
        shortest.append(min(times))
    assert shortest[1] < 2.5 * shortest[0]


def test_bones_without_length_do_no_harm(posed: Array) -> None:
    tree = Tree(
        (-1, 0, 1, 2, 1), np.array([[0, 0, 0], [0, 0.1, 0], [0, 0, 0], [0.1, 0, 0], [0, 0, 0.0]])
    )
    found = solve_tree(tree, [Target(3, np.array([[0.05, 0.1, 0.02]]))], rest(1)[:, :5])
    assert np.isfinite(found.rotations).all()


def test_targets_that_are_none_are_refused(body: Tree) -> None:
    for target in (Target(0, np.zeros((1, 3))), Target(LEFT, np.full((1, 3), np.nan))):
        with pytest.raises(CharacterError, match="leave it out"):
            solve_tree(body, [target], rest(1))
    with pytest.raises(CharacterError, match="list the base first"):
        Tree((-1, 2, 1), np.zeros((3, 3)))
