"""Chains reach what they can reach, in the ways of Huang's S14, S16 and S18."""

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

from cubeling.characters.errors import CharacterError
from cubeling.characters.ik.solvers.chains import Chains
from cubeling.characters.ik.solvers.measures import (
    ReachingProblem,
    arc_targets,
    joint_change,
    violations,
    zig_zag,
)
from cubeling.characters.ik.solvers.methods.springs import MassSprings, verlet
from cubeling.characters.ik.solvers.single import SingleChain
from cubeling.characters.ik.solvers.solving import SOLVERS, solve
from cubeling.characters.skeleton import rotations
from cubeling.characters.skeleton.joint_limits import AngleLimits
from cubeling.characters.skeleton.pose import Array
from tests.examples import examples, some

COUNT = 25


@pytest.fixture(scope="module", params=some([6, 10]))
def problem(request: pytest.FixtureRequest) -> ReachingProblem:
    return ReachingProblem.random(request.param, COUNT, np.random.default_rng(3))


def bone_errors(chains: Chains, positions: Array) -> Array:
    """Return the relative errors of the lengths of bones."""
    lengths = np.linalg.norm(np.diff(positions, axis=-2), axis=-1)
    errors: Array = np.abs(lengths / chains.lengths - 1)
    return errors


@pytest.mark.parametrize("method", SOLVERS)
def test_rotations_reproduce_the_points_with_exact_bones(
    method: str, problem: ReachingProblem
) -> None:
    found = solve(problem.free, problem.targets, problem.start, method=method, alone=True)
    _, points = problem.free.frames(found.rotations)
    assert np.abs(points - found.positions).max() < 1e-9
    assert bone_errors(problem.free, found.positions).max() < 1e-9
    assert np.allclose(np.linalg.norm(found.rotations, axis=-1), 1.0)


@pytest.mark.parametrize(
    "method", ["springs-force", "springs", "fabrik", "pseudo-inverse", "damped"]
)
def test_method_alone_reaches_nearly_all_targets(method: str, problem: ReachingProblem) -> None:
    found = solve(problem.free, problem.targets, problem.start, method=method, alone=True)
    assert found.solved.mean() >= 0.99
    ends = np.linalg.norm(found.positions[:, -1] - problem.targets, axis=-1)
    assert (ends[found.solved] <= 1e-3 * problem.free.reach).all()


@pytest.mark.parametrize("limits", some(["propagate", "clamp"]))
@pytest.mark.parametrize("method", SOLVERS)
def test_every_method_made_sure_reaches_all_within_limits(
    method: str, limits: str, problem: ReachingProblem
) -> None:
    found = solve(
        problem.chains,
        problem.targets,
        problem.start,
        method=method,
        limits="propagate" if limits == "propagate" else "clamp",
    )
    assert found.solved.mean() >= 0.995
    assert violations(problem.chains, found) == 0


@pytest.mark.parametrize("method", SOLVERS)
def test_method_alone_never_leaves_the_limits(method: str, problem: ReachingProblem) -> None:
    """Neither for targets that are reached nor for those beyond."""
    targets = np.concatenate([problem.targets, 1.5 * problem.targets])
    start = np.concatenate([problem.start, problem.start])
    found = solve(problem.chains, targets, start, method=method, alone=True)
    assert violations(problem.chains, found) == 0


def test_position_based_springs_need_fewer_steps_than_force_based(problem: ReachingProblem) -> None:
    steps = [
        solve(problem.free, problem.targets, problem.start, method=method, alone=True).iterations
        for method in ("springs", "springs-force")
    ]
    assert steps[0].mean() < steps[1].mean()


@pytest.mark.parametrize("method", ["springs-force", "springs", "damped"])
def test_joints_change_less_than_by_cyclic_descent(method: str, problem: ReachingProblem) -> None:
    changes = []
    for each in (method, "ccd"):
        found = solve(problem.free, problem.targets, problem.start, method=each, alone=True)
        changes.append(joint_change(problem.start, found.rotations)[found.solved].mean())
    assert changes[0] <= changes[1]


@pytest.mark.parametrize("method", SOLVERS)
def test_chain_points_straight_to_what_is_out_of_reach(method: str) -> None:
    chains = Chains.straight(np.array([0.3, 0.1, 0.2, 0.2]))
    directions = np.random.default_rng(5).normal(size=(50, 3))
    targets = directions / np.linalg.norm(directions, axis=1, keepdims=True) * 0.9
    found = solve(chains, targets, arc_targets(4, 50), method=method)
    bones = np.diff(found.positions, axis=1) / chains.lengths[:, None]
    cosines = (bones * targets[:, None] / 0.9).sum(-1)
    assert np.degrees(np.arccos(np.clip(cosines, -1, 1))).max() < 2.0
    assert bone_errors(chains, found.positions).max() < 1e-3
    assert not found.solved.any()


def test_target_too_near_for_one_long_bone_is_approached(problem: ReachingProblem) -> None:
    chains = Chains.straight(np.array([0.4, 0.1, 0.1]))
    found = solve(chains, np.array([[0.05, 0.0, 0.0], [0.0, 0.0, 0.0]]))
    assert np.allclose(found.errors, [0.15, 0.2], atol=2e-3)


def test_constant_acceleration_is_exact_by_verlet_and_late_by_euler() -> None:
    speed, acceleration, step, steps = 0.7, -0.4, 0.1, 50
    times = step * np.arange(steps + 1)
    exact = speed * times + 0.5 * acceleration * times**2
    place, before = exact[1], exact[0]
    euler, velocity = 0.0, speed
    for number in range(1, steps + 1):
        euler += step * velocity
        velocity += step * acceleration
        if number >= 2:
            place, before = verlet(place, before, np.array(acceleration * step**2)), place
    assert place == pytest.approx(exact[-1], abs=1e-12)
    late = 0.5 * acceleration * times[-1] * step
    assert euler - exact[-1] == pytest.approx(-late, abs=1e-12)


def test_pinned_end_stays_at_the_target() -> None:
    problem = ReachingProblem.random(6, 5, np.random.default_rng(0))
    found = solve(problem.free, problem.targets, problem.start, method="springs", tolerance=1e-5)
    assert found.errors.max() < 1e-5 * problem.free.reach
    assert MassSprings(pinned=True).stiffness < (2 - MassSprings(pinned=True).damping) / 2


def test_limits_wide_open_change_nothing(problem: ReachingProblem) -> None:
    wide = Chains(problem.free.offsets, AngleLimits.none(problem.free.joints))
    for method in SOLVERS:
        free = solve(problem.free, problem.targets, problem.start, method=method, alone=True)
        open_ = solve(wide, problem.targets, problem.start, method=method, alone=True)
        both = free.solved & open_.solved
        assert both.mean() > 0.8
        assert np.abs(free.positions - open_.positions)[both].max() < 2e-3, method


def test_zig_zag_is_counted() -> None:
    curl = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0.5, 0]]
    fold = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [2, 1, 0], [2, 2, 0]]
    assert zig_zag(np.array([curl, fold], float)).tolist() == [0.0, 2.0]


@pytest.mark.parametrize("method", ["springs", "fabrik", "damped"])
def test_chain_curls_without_zig_zag_to_targets_near_its_base(method: str) -> None:
    directions = np.random.default_rng(1).normal(size=(40, 3))
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    for joints in (3, 6, 10):
        chains = Chains.straight(np.full(joints, 1 / joints))
        targets = 0.02 * directions * np.arange(1, 11).repeat(4)[:, None]
        found = solve(chains, targets, arc_targets(joints, 40), method=method)
        assert found.solved.all()
        assert zig_zag(found.positions).sum() == 0


def hard_places() -> Array:
    return np.array(
        [
            [0.0, 0.0, 0.0], [0.6, 0.0, 0.0], [-0.6, 0.0, 0.0], [-0.3, 0.0, 0.0],
            [1e300, 0.0, 0.0], [1e-300, 0.0, 0.0], [np.nan, 0.0, 0.0], [0.0, np.inf, 0.0],
            [0.3, 0.0, 0.0], [0.0, -9.0, 0.0],
        ]
    )  # fmt: skip


BONES = [0.1] * 6, [0.0] * 6, [0.3, 0.0, 0.0, 0.2, 0.0, 0.1], [0.6], [0.3, 0.3]
HARD = [
    (method, BONES[(number + turn) % len(BONES)])
    for turn in range(len(BONES))
    for number, method in enumerate(SOLVERS)
]
"""Each method with each list of bones; the first have every method and every list."""


@pytest.mark.parametrize(("method", "lengths"), some(HARD, len(SOLVERS)))
def test_hard_targets_and_bones_give_numbers(method: str, lengths: list[float]) -> None:
    targets = hard_places()
    for limited in (False, True):
        limits = AngleLimits.of_angles(
            np.full((len(lengths), 3), -1.0), np.full((len(lengths), 3), 1.0)
        )
        chains = Chains.straight(np.array(lengths), limits if limited else None)
        found = solve(chains, targets, method=method)
        assert np.isfinite(found.rotations).all()
        assert np.isfinite(found.positions).all()
        assert not np.isnan(found.errors).any()
        assert not found.solved[[4, 6, 7, 9]].any()
        assert violations(chains, found) == 0
    if lengths == [0.1] * 6:
        assert solve(chains, targets, limits=None, method=method).solved[[0, 1, 2, 3, 8]].all()


def test_arrays_that_do_not_fit_are_refused_in_one_line() -> None:
    chains = Chains.straight(np.full(3, 0.1))
    with pytest.raises(CharacterError, match="no solver 'magic'"):
        solve(chains, np.zeros((1, 3)), method="magic")
    with pytest.raises(CharacterError, match="targets of shape"):
        solve(chains, np.zeros((2, 2)))
    with pytest.raises(CharacterError, match="2 chains for 3 targets"):
        solve(Chains.straight(np.full((2, 3), 0.1)), np.zeros((3, 3)))
    with pytest.raises(CharacterError, match="not finite"):
        Chains.straight(np.array([0.1, np.nan]))
    with pytest.raises(CharacterError, match="limits of 2 joints for chains of 3"):
        Chains.straight(np.full(3, 0.1), AngleLimits.none(2))


def test_each_chain_of_a_batch_may_have_its_own_bones() -> None:
    random = np.random.default_rng(2)
    lengths = random.uniform(0.05, 0.3, (20, 4))
    chains = Chains.straight(lengths)
    _, points = chains.frames(Chains.straight(lengths[0]).random(20, random))
    found = solve(chains, points[:, -1])
    assert found.solved.all()
    alone = solve(Chains.straight(lengths[7]), points[7:8, -1])
    assert np.allclose(alone.positions[0], found.positions[7], atol=1e-9)


@settings(max_examples=examples(40), deadline=None)
@given(st.integers(0, 10_000), st.booleans())
def test_one_chain_in_scalars_is_the_batch_of_one(seed: int, limited: bool) -> None:
    problem = ReachingProblem.random(5, 1, np.random.default_rng(seed))
    chains = problem.chains if limited else problem.free
    batch = solve(chains, problem.targets, problem.start, alone=True)
    x, y, z = problem.targets[0].tolist()
    one = SingleChain(chains).solve((x, y, z), problem.start[0].tolist(), alone=True)
    assert np.abs(np.array(one.positions) - batch.positions[0]).max() < 1e-6
    assert one.iterations == batch.iterations[0]


def test_one_chain_made_sure_is_solved_like_a_batch() -> None:
    problem = ReachingProblem.random(4, 60, np.random.default_rng(8))
    one = SingleChain(problem.chains)
    for (x, y, z), start in zip(problem.targets.tolist(), problem.start, strict=True):
        found = one.solve((x, y, z), start.tolist())
        assert found.error <= 1e-3 * one.reach
        assert problem.chains.limits is not None
        assert problem.chains.limits.excess(np.array(found.rotations)).max() < 1e-9


def test_one_chain_points_straight_to_what_is_out_of_reach() -> None:
    one = SingleChain(Chains.straight(np.array([0.3, 0.3])))
    found = one.solve((0.0, 2.0, 0.0), rotations.about("z", np.array([0.3, 0.3])).tolist())
    straight = np.array([[0, 0, 0], [0, 0.3, 0], [0, 0.6, 0]])
    assert np.allclose(np.array(found.positions), straight, atol=1e-9)
    assert found.error == pytest.approx(1.4)
