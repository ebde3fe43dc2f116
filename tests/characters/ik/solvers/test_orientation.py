"""Rotations from positions (S13, S15)."""

import numpy as np
from hypothesis import given, strategies as st

from cubeling.characters.ik.solvers import columns
from cubeling.characters.ik.solvers.chains import Chains
from cubeling.characters.ik.solvers.measures import ReachingProblem, arc_targets, target_path, twist
from cubeling.characters.ik.solvers.solving import solve
from cubeling.characters.skeleton import rotations
from cubeling.characters.skeleton.joint_limits import to_euler


def test_up_vectors_stay_perpendicular_to_their_bones() -> None:
    problem = ReachingProblem.random(6, 50, np.random.default_rng(2))
    found = solve(problem.free, problem.targets, problem.start, method="springs")
    frames, _ = problem.free.frames(found.rotations)
    bones = np.diff(found.positions, axis=1)
    up = rotations.rotate(frames, np.array([0.0, 0.0, 1.0]))
    assert np.abs((bones * up).sum(-1)).max() < 1e-9


def test_bones_do_not_twist_while_a_chain_follows_its_target() -> None:
    count, start = 20, arc_targets(6, 20)
    problem = ReachingProblem.random(6, count, np.random.default_rng(3))
    random = np.random.default_rng(4)
    paths = np.stack([target_path(60, 0.01, random) for _ in range(count)], 1)
    for chains, share, most in ((problem.free, 1.0, 0.01), (problem.chains, 0.99, 5.0)):
        postures = [start]
        for places in paths:
            postures.append(solve(chains, places, postures[-1]).rotations)
        ways = np.stack(postures[2:])
        twists = [twist(chains, start[0], ways[:, number]) for number in range(count)]
        assert np.nanquantile(twists, share) < most


@given(st.lists(st.floats(-3.1, 3.1), min_size=3, max_size=3))
def test_euler_angles_and_quaternions_agree(angles: list[float]) -> None:
    first, middle, last = angles[0], angles[1] / 2.2, angles[2]
    wanted = np.array([first, middle, last])
    turn = rotations.from_euler("zyx", wanted[::-1])
    back = to_euler(turn)
    assert np.abs(np.angle(np.exp(1j * (back - wanted)))).max() < 1e-9
    column = columns.from_euler(wanted[:, None])
    assert np.allclose(column[:, 0], rotations.align(turn, column[:, 0]), atol=1e-12)
    assert np.allclose(columns.to_euler(column)[:, 0], back, atol=1e-9)


def test_slerp_turns_at_constant_speed() -> None:
    random = np.random.default_rng(7)
    a, b = (rotations.normalize(random.normal(size=4)) for _ in "ab")
    between = rotations.slerp(a, b, np.linspace(0, 1, 11))
    steps = rotations.multiply(between[1:], rotations.conjugate(between[:-1]))
    speeds = np.linalg.norm(rotations.to_rotation_vector(steps), axis=-1)
    assert np.ptp(speeds) < 1e-9
    q = rotations.multiply(b, rotations.conjugate(a))
    part = columns.share(q[:, None], np.array([0.3]))[:, 0]
    expected = rotations.slerp(rotations.IDENTITY, q, 0.3)
    assert np.allclose(rotations.align(part, expected), expected, atol=1e-12)


def test_frames_agree_with_a_chain_of_matrices() -> None:
    random = np.random.default_rng(8)
    chains = Chains(random.normal(size=(5, 3)))
    local = chains.random(1, random)
    turns, points = chains.frames(local)
    matrix = np.eye(4)
    for joint in range(5):
        turn, move = np.eye(4), np.eye(4)
        turn[:3, :3] = rotations.to_matrix(local[0, joint])
        move[:3, 3] = chains.offsets[joint]
        assert np.allclose((matrix @ turn)[:3, :3], rotations.to_matrix(turns[0, joint]))
        matrix = matrix @ turn @ move
        assert np.allclose(matrix[:3, 3], points[0, joint + 1])
    turned, _ = chains.frames(local)
    assert np.allclose(columns.to_columns(turned)[..., 0], turned[0])
