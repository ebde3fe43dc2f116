"""The figures and laws of specification S12, the MIRAnim blending engine."""

import math
from itertools import permutations

import numpy as np
import pytest
from hypothesis import given, strategies as st

from cubeling.characters import (
    Action,
    Adsr,
    CharacterError,
    Clip,
    FadeCurve,
    Keyed,
    LiveSchedule,
    Pose,
    Product,
    RootDelta,
    Schedule,
    Skeleton,
    mask_of,
)
from cubeling.characters.motion.curves import ease
from cubeling.characters.motion.phase import StaticPose
from cubeling.characters.skeleton import rotations

REST = Pose(np.zeros((3, 3)), np.tile(rotations.IDENTITY, (3, 1)))
SKELETON = Skeleton(("legs", "torso", "arm"), (-1, 0, 1), REST)
TORSO = mask_of(SKELETON, {"torso": 1.0})
IDLE_MASK = mask_of(SKELETON, {"torso": 0.1}, default=1.0)


def still(x: float, length: float = 1.0, angle: float = 0.0, morphs: list[float] | None = None):
    turns = np.tile(rotations.about("y", angle), (3, 1))
    looks = None if morphs is None else np.array(morphs)
    return StaticPose(Pose(np.full((3, 3), x), turns, None, looks), length)


def x_of(schedule: Schedule, time: float) -> list[float]:
    return [float(x) for x in schedule.sample(time).translations[:, 0]]


def test_two_equal_actions_give_the_mean():
    schedule = Schedule((Action(still(1.0, angle=0.2)), Action(still(3.0, angle=0.8))), REST)
    pose = schedule.sample(0.5)
    assert pose.translations[:, 0] == pytest.approx(2.0)
    assert np.allclose(pose.rotations, rotations.about("y", 0.5))


def example(curve: FadeCurve | float = 1.0) -> Schedule:
    """Idle with a light torso, and from 1 s on a gesture of the torso alone: examples 3 and 4."""
    return Schedule(
        (
            Action(still(0.0, 10.0), mask=IDLE_MASK),
            Action(still(1.0, 5.0), start=1.0, weight=curve, mask=TORSO),
        ),
        REST,
    )


def test_a_gesture_over_a_light_idle_has_a_share_of_ten_elevenths():
    assert x_of(example(), 0.99) == [0.0, 0.0, 0.0]
    legs, torso, arm = x_of(example(), 2.0)
    assert legs == 0.0
    assert torso == arm == pytest.approx(0.9091, abs=5e-5)
    assert x_of(example(), 6.01) == [0.0, 0.0, 0.0]


def test_half_faded_in_its_share_is_five_sixths():
    fade = FadeCurve.percent(20, 20, 5.0)
    assert (fade.fade_in, fade.fade_out) == (1.0, 1.0)
    for time in (1.5, 5.5):
        assert fade.at(time - 1.0, 5.0) == pytest.approx(0.5)
        assert x_of(example(fade), time)[1] == pytest.approx(0.8333, abs=5e-5)


@pytest.mark.parametrize("order", list(permutations(range(3))))
def test_the_order_of_actions_does_not_matter(order):
    actions = (
        Action(still(1.0, angle=0.1), weight=0.5),
        Action(still(2.0, angle=1.2), mask=TORSO),
        Action(still(-1.0, angle=-0.9), weight=2.0, scale=0.5),
    )
    a = Schedule(actions, REST).sample(0.5)
    b = Schedule(tuple(actions[i] for i in order), REST).sample(0.5)
    assert np.allclose(a.translations, b.translations)
    assert np.allclose(rotations.align(a.rotations, b.rotations), b.rotations)


def test_of_many_equal_and_far_poses_the_order_does_not_matter_either():
    rng = np.random.default_rng(1)
    rest = Pose(np.zeros((200, 3)), np.tile(rotations.IDENTITY, (200, 1)))
    for spread in (1.0, 3.0):
        turns = rotations.from_rotation_vector(rng.uniform(-spread, spread, (4, 200, 3)))
        actions = [Action(StaticPose(Pose(rest.translations, turn), 1.0)) for turn in turns]
        a, b = (Schedule(tuple(x), rest).sample(0.0).rotations for x in (actions, actions[::-1]))
        assert np.abs(rotations.align(a, b) - b).max() < 1e-9


weights = st.floats(0.01, 5.0)


@given(weights, weights, weights, weights, st.floats(0.2, 2.0))
def test_a_nested_schedule_is_the_flattened_one(a, b, outer, other, scale):
    poses = [still(1.0, angle=0.3), still(4.0, angle=1.5), still(-2.0, angle=-0.4)]
    inner = Schedule((Action(poses[0], weight=a), Action(poses[1], weight=b)), REST)
    nested = Schedule(
        (Action(inner, weight=outer, mask=IDLE_MASK, scale=scale), Action(poses[2], weight=other)),
        REST,
    )
    flat = Schedule(
        (
            Action(poses[0], weight=outer * a / (a + b), mask=IDLE_MASK, scale=scale),
            Action(poses[1], weight=outer * b / (a + b), mask=IDLE_MASK, scale=scale),
            Action(poses[2], weight=other),
        ),
        REST,
    )
    one, two = nested.sample(0.5), flat.sample(0.5)
    assert np.allclose(one.translations, two.translations, atol=1e-12)
    assert np.allclose(one.rotations, two.rotations, atol=1e-12)


@pytest.mark.parametrize("shape", ["cubic", "gonio"])
def test_smooth_fades_start_and_end_without_speed(shape):
    fade = FadeCurve(1.0, 0.5, shape)
    tiny = 1e-6
    for time in (0.0, 1.0, 2.5, 3.0):
        before, at, after = (fade.at(time + d, 3.0) for d in (-tiny, 0.0, tiny))
        assert abs(after - at) / tiny < 1e-4
        assert abs(at - before) / tiny < 1e-4


def test_fades_follow_their_formulas():
    u = 0.3
    assert ease(u, "linear") == u
    assert ease(u, "cubic") == pytest.approx(3 * u**2 - 2 * u**3)
    assert ease(u, "gonio") == pytest.approx((1 - math.cos(math.pi * u)) / 2)


def test_an_envelope_attacks_decays_sustains_and_releases():
    curve = Adsr(1.0, 2.0, 0.25, 1.0, "linear")
    shown = [curve.at(t, 10.0) for t in (0.0, 0.5, 1.0, 2.0, 3.0, 8.0, 9.5, 10.0)]
    assert shown == pytest.approx([0.0, 0.5, 1.0, 0.625, 0.25, 0.25, 0.125, 0.0])
    assert curve.at(1e9, math.inf) == 0.25


def test_merged_curves_are_multiplied():
    curve = Product((0.5, FadeCurve(1.0), Keyed((0.0, 2.0), (1.0, 3.0), "linear")))
    assert curve.at(0.5, math.inf) == pytest.approx(0.5 * 0.5 * 1.5)


def test_one_key_frame_times_a_curve_raises_the_eyebrows():
    raised = Action(still(1.0, 2.0), scale=Keyed((0.0, 1.0, 2.0), (0.0, 1.0, 0.0), "linear"))
    schedule = Schedule((raised,), REST)
    assert [x_of(schedule, t)[0] for t in (0.0, 0.5, 1.0, 2.0)] == pytest.approx([0, 0.5, 1, 0])


def test_always_plays_outside_its_time_and_idle_joints_show_the_rest_pose():
    schedule = Schedule((Action(still(5.0, 1.0), start=1.0),), REST)
    assert [x_of(schedule, t)[0] for t in (0.5, 1.0, 2.0, 2.5)] == [0.0, 5.0, 5.0, 0.0]
    endless = Schedule((Action(still(5.0, 1.0), start=1.0, always=True),), REST)
    assert [x_of(endless, t)[0] for t in (-9.0, 99.0)] == [5.0, 5.0]
    assert schedule.duration == 2.0


def test_actions_without_morphs_do_not_dampen_morphs():
    body, smile = Action(still(1.0)), Action(still(0.0, morphs=[0.8]), mask=np.zeros(3))
    pose = Schedule((body, smile), REST).sample(0.5)
    assert pose.morphs == pytest.approx([0.8])
    assert pose.translations[:, 0] == pytest.approx(1.0)


def test_actions_come_and_go_without_a_jump():
    live = LiveSchedule(Schedule((Action(still(0.0), always=True, weight=0.1),), REST))
    live.add(Action(still(1.0, 9.0), start=1.0, weight=FadeCurve(0.5), name="wave"))
    times = np.arange(0.9, 4.0, 0.01)
    shown = []
    for time in times:
        if abs(time - 2.0) < 1e-9:
            live.cut("wave", time, 0.5)
        shown.append(live.sample(time).translations[0, 0])
    assert max(shown) == pytest.approx(1 / 1.1)
    assert shown[-1] == 0.0
    # A light idle leaves most of a fade to its first and last moments.
    assert np.abs(np.diff(shown)).max() < 0.1
    live.remove("wave")
    assert live.sample(1.9).translations[0, 0] == 0.0
    with pytest.raises(CharacterError, match="no action 'wave'"):
        live.cut("wave", 5.0)


def test_duplicate_action_names_are_refused():
    with pytest.raises(CharacterError, match="two actions are named 'a'"):
        Schedule((Action(still(0.0), name="a"), Action(still(1.0), name="a")), REST)


def test_the_root_follows_the_actions_by_their_weight_of_joint_0():
    shifts = np.zeros((11, 3, 3))
    shifts[:, 0, 2] = np.arange(11) / 10
    turns = np.tile(rotations.IDENTITY, (11, 3, 1))
    walk = Clip("walk", 10.0, Pose(shifts, turns), True, True)
    gesture = Action(still(0.0, 5.0), mask=TORSO)
    alone = Schedule((Action(walk, always=True), gesture), REST)
    assert alone.travel(0.0, 2.0).z == pytest.approx(2.0)
    half = Schedule((Action(walk, always=True), Action(still(0.0, 5.0))), REST)
    assert half.travel(0.0, 2.0).z == pytest.approx(1.0)
    assert Schedule((), REST).travel(0.0, 2.0) == RootDelta()
