import numpy as np
import pytest
from hypothesis import given, strategies as st

from cubeling.characters import (
    BlendSpace1D,
    BlendSpace2D,
    CharacterError,
    Clip,
    Motion,
    Pose,
    Schedule,
    StateMachine,
)
from cubeling.characters.motion.blend import Blend, TimeScaled, mix, shares
from cubeling.characters.motion.phase import Cyclic, PhasedMotion, StaticPose, as_cyclic, with_phase
from cubeling.characters.skeleton import rotations

coordinates = st.floats(-2, 2)
point = st.tuples(coordinates, coordinates)
points = st.lists(point, min_size=1, max_size=7, unique=True).filter(
    lambda ps: all(
        np.hypot(a[0] - b[0], a[1] - b[1]) > 0.05 for i, a in enumerate(ps) for b in ps[:i]
    )
)


def still(angle):
    pose = Pose(np.array([[angle, 0.0, 0.0]]), rotations.about("y", [angle]))
    return StaticPose(pose, 1.0)


def plane(ps):
    return BlendSpace2D(np.array(ps), tuple(still(0.0) for _ in ps))


@given(points, point)
def test_weights_in_the_plane_are_a_partition_of_one(ps, at):
    weights = plane(ps).weights(at)
    assert min(weights) >= 0
    assert sum(weights) == pytest.approx(1)


@given(points)
def test_at_a_point_of_the_plane_only_its_motion_is_active(ps):
    for number, at in enumerate(ps):
        assert plane(ps).weights(at)[number] == pytest.approx(1)


@given(points, point, st.randoms(use_true_random=False))
def test_weights_in_the_plane_do_not_depend_on_the_order(ps, at, random):
    order = list(range(len(ps)))
    random.shuffle(order)
    shuffled = plane([ps[i] for i in order]).weights(at)
    assert np.allclose(shuffled, np.array(plane(ps).weights(at))[order])


@given(points, point, st.tuples(st.floats(-1, 1), st.floats(-1, 1)))
def test_weights_in_the_plane_are_continuous(ps, at, direction):
    near = np.array(at) + 1e-6 * np.array(direction)
    # Each influence is Lipschitz with one over the least distance, here 1 / 0.05.
    assert np.allclose(plane(ps).weights(near), plane(ps).weights(at), atol=3e-4)


@given(points, point, point)
def test_weights_in_the_plane_change_no_faster_than_points_are_near(ps, a, b):
    gaps = [np.hypot(p[0] - q[0], p[1] - q[1]) for i, p in enumerate(ps) for q in ps[:i]]
    # An influence changes by 1 over a gap, and the nearest point's alone is one half or more.
    steepest = 2 * (1 + len(ps)) / min(gaps, default=1.0)
    change = np.subtract(plane(ps).weights(a), plane(ps).weights(b))
    assert np.abs(change).max() <= steepest * np.hypot(a[0] - b[0], a[1] - b[1]) + 1e-9


@given(st.lists(st.floats(0, 9), min_size=1, max_size=5).filter(lambda w: sum(w) > 1e-3))
def test_shares_make_weights_that_a_blend_takes(weights):
    assert Blend(tuple(still(0.1) for _ in weights), shares(weights)).duration == pytest.approx(1)
    with pytest.raises(CharacterError, match="one above it"):
        shares([0.0 for _ in weights])


def test_mixing_poses_of_two_skeletons_is_refused():
    two = Pose(np.zeros((2, 3)), np.tile(rotations.IDENTITY, (2, 1)))
    with pytest.raises(CharacterError, match="retarget"):
        mix([still(0.0).pose, two], [0.5, 0.5])


@given(st.floats(-150, 150))
def test_on_a_line_at_most_two_neighbours_are_active(value):
    space = BlendSpace1D((-90.0, -30.0, 0.0, 45.0, 90.0), tuple(still(0.0) for _ in range(5)))
    weights = np.array(space.weights(value))
    active = np.flatnonzero(weights)
    assert weights.sum() == pytest.approx(1)
    assert weights.min() >= 0
    assert len(active) <= 2
    assert np.ptp(active) <= 1
    assert weights @ space.knots == pytest.approx(np.clip(value, -90, 90))


def test_descending_knots_and_equal_points_are_refused():
    with pytest.raises(CharacterError, match="ascending"):
        BlendSpace1D((1.0, 0.0), (still(0), still(1)))
    with pytest.raises(CharacterError, match="a different point"):
        plane([(0, 0), (0, 0)])


@given(st.permutations(range(4)))
def test_a_mix_does_not_depend_on_order_or_on_signs(order):
    weights = [0.4, 0.3, 0.2, 0.1]
    poses = [still(0.3 * i).pose for i in range(4)]
    flipped = Pose(poses[2].translations, -poses[2].rotations)
    poses_flipped = [poses[0], poses[1], flipped, poses[3]]
    expected = mix(poses, weights)
    mixed = mix([poses_flipped[i] for i in order], [weights[i] for i in order])
    assert np.allclose(mixed.translations, expected.translations)
    assert np.allclose(rotations.align(mixed.rotations, expected.rotations), expected.rotations)


def test_blends_nest_and_are_motions(walker, skeleton):
    walk, run = (with_phase(walker.clips[name], skeleton) for name in ("Walk", "Run"))
    inner = Blend((walk, run), (0.5, 0.5))
    outer = TimeScaled(Blend((inner, walk), (0.5, 0.5)), 1.5)
    flat = TimeScaled(Blend((walk, run), (0.75, 0.25)), 1.5)
    cyclic: Cyclic = outer
    assert isinstance(cyclic, Motion)
    assert outer.duration == pytest.approx(flat.duration)
    assert outer.travel(0.1, 0.4).z == pytest.approx(flat.travel(0.1, 0.4).z)
    assert np.allclose(outer.sample(0.3).translations, flat.sample(0.3).translations)


def test_the_speed_of_a_blend_is_the_mean_of_its_members_speeds(walker, skeleton):
    walk, run = (with_phase(walker.clips[name], skeleton) for name in ("Walk", "Run"))
    blend = Blend((walk, run), (0.25, 0.75))
    assert 1 / blend.duration == pytest.approx(0.25 / walk.duration + 0.75 / run.duration)


@pytest.mark.parametrize("weight", [0.0, 0.25, 0.5, 0.75, 1.0])
def test_in_any_blend_of_walk_and_run_left_feet_land_together(walker, skeleton, weight):
    members = tuple(with_phase(walker.clips[name], skeleton) for name in ("Walk", "Run"))
    blend = Blend(members, (1 - weight, weight))
    phases = np.arange(200) / 200
    feet = np.array([blend.at(phase).globals(skeleton)[3:5, :3, 3] for phase in phases])
    forward = feet[:, :, 2]
    # Unaligned, these clips would land half a cycle apart and cancel each other's swing.
    swing = np.ptp(forward, axis=0)
    single = [np.ptp([m.at(p).translations[3, 2] for p in phases]) for m in members]
    assert swing == pytest.approx((1 - weight) * single[0] + weight * single[1], rel=0.06)
    away = (phases[forward.argmax(0)] - [0.0, 0.5] + 0.5) % 1.0 - 0.5
    assert np.abs(away).max() < 0.06


def test_clips_without_footfalls_have_phase_0_at_their_start(actor):
    clip = actor.clips["kiss_tail"]
    assert np.allclose(
        PhasedMotion(clip).at(0.25).rotations, clip.sample(0.25 * clip.duration).rotations
    )


def test_motions_without_a_cycle_play_in_real_time():
    rest = Pose(np.zeros((1, 3)), np.array([[0.0, 0.0, 0.0, 1.0]]))
    empty = Schedule((), rest)
    assert TimeScaled(as_cyclic(empty), 2.0).sample(3.0).rotations.shape == (1, 4)
    turns = rotations.about("y", np.linspace(0.0, 1.0, 11))[:, None]
    clip = Clip("turn", 10.0, Pose(np.zeros((11, 1, 3)), turns), loop=False)
    machine = StateMachine({"turn": clip}, "turn")
    shown = TimeScaled(as_cyclic(machine), 2.0).sample(0.25)
    assert shown.rotations == pytest.approx(clip.sample(0.5).rotations)
