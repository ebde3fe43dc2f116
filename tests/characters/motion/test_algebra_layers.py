import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

from cubeling.characters import (
    AdditiveLayer,
    BlendSpace2D,
    Clip,
    CrossFade,
    MaskedLayer,
    Pose,
    RootDelta,
    Skeleton,
    StateMachine,
    mask_of,
)
from cubeling.characters.motion.phase import StaticPose
from cubeling.characters.skeleton import rotations
from tests.examples import examples

REST = Pose(np.zeros((3, 3)), np.tile(rotations.IDENTITY, (3, 1)))
SKELETON = Skeleton(("root", "spine", "arm"), (-1, 0, 1), REST)
numbers = st.floats(-2.0, 2.0)


class Swing:
    """Joints that turn and shift at bounded speed; counts how often it is asked for a pose."""

    duration = 2.0

    def __init__(self, seed: int = 0) -> None:
        rng = np.random.default_rng(seed)
        self.size, self.pace = rng.uniform(-0.6, 0.6, (2, 3, 3)), rng.uniform(1.0, 6.0)
        self.asked = 0

    def sample(self, time: float) -> Pose:
        self.asked += 1
        turns = rotations.from_rotation_vector(self.size[0] * np.sin(self.pace * time))
        return Pose(self.size[1] * np.cos(self.pace * time), turns, None, np.array([0.5, 0.2]))

    def travel(self, start: float, end: float) -> RootDelta:
        return RootDelta(0.0, end - start, 0.1 * (end - start))


def same(a: Pose, b: Pose) -> bool:
    return np.array_equal(a.translations, b.translations) and np.array_equal(
        a.rotations, b.rotations
    )


def test_a_layer_keeps_the_exact_values_of_other_joints():
    base, over = Swing(1), Swing(2)
    mask = mask_of(SKELETON, {"arm": 1.0})
    below, above = base.sample(0.3), over.sample(0.3)
    pose = MaskedLayer(base, over, mask).sample(0.3)
    assert np.array_equal(pose.rotations[:2], below.rotations[:2])
    assert np.allclose(pose.rotations[2], above.rotations[2])
    assert MaskedLayer(base, over, mask).travel(0.0, 1.0) == base.travel(0.0, 1.0)


def test_a_layer_rotates_the_shorter_way():
    a = StaticPose(Pose(REST.translations, rotations.about("y", np.full(3, 0.4))), 1.0)
    b = StaticPose(Pose(REST.translations, -rotations.about("y", np.full(3, 0.8))), 1.0)
    pose = MaskedLayer(a, b, weight=0.5).sample(0.0)
    assert np.allclose(pose.rotations, rotations.about("y", 0.6))


@given(numbers, numbers)
def test_an_additive_layer_without_difference_changes_nothing(time, weight):
    base, over = Swing(3), Swing(4).sample(0.7)
    pose, expected = (
        AdditiveLayer(base, StaticPose(over, 1.0), weight=weight).sample(time),
        base.sample(time),
    )
    assert same(pose, expected)
    assert pose.morphs is not None
    assert expected.morphs is not None
    assert np.array_equal(pose.morphs, expected.morphs)


def test_an_addition_turns_in_the_parents_frame_and_in_part():
    base = StaticPose(Pose(REST.translations, rotations.about("x", np.full(3, 1.0))), 1.0)
    lean = StaticPose(Pose(REST.translations, rotations.about("y", np.full(3, 0.6))), 1.0)
    mask = mask_of(SKELETON, {"spine": 1.0, "arm": 0.5})
    pose = AdditiveLayer(base, lean, REST, mask=mask).sample(0.0)
    expected = rotations.multiply(rotations.about("y", [0.0, 0.6, 0.3]), base.pose.rotations)
    assert np.allclose(pose.rotations, expected)


def test_what_is_added_and_taken_away_again_leaves_the_base():
    base, over = Swing(5), Swing(6)
    there = AdditiveLayer(base, over, REST)
    back = AdditiveLayer(there, over, REST, weight=-1.0)
    # The inverse is applied on the same side, so it undoes the addition.
    assert np.allclose(back.sample(0.4).rotations, base.sample(0.4).rotations)
    assert np.allclose(back.sample(0.4).translations, base.sample(0.4).translations)


def test_masks_name_joints_subtrees_and_roles():
    mask = mask_of(SKELETON, {"spine": 0.8, "hand": 0.2}, {"root": 0.5}, 0.0, {"hand": 2})
    assert mask.tolist() == [0.5, 0.8, 0.2]


@settings(max_examples=examples(40))
@given(st.lists(st.tuples(st.sampled_from("abc"), st.floats(0.0, 0.4)), max_size=8))
def test_a_state_machine_is_continuous_at_any_switch(requests):
    states = {name: Swing(seed) for seed, name in enumerate("abc")}
    machine = StateMachine(states, "a")
    now, step = 0.0, 0.005
    before = machine.sample(now)
    for state, wait in requests:
        for _ in range(round(wait / step)):
            now += step
            pose = machine.sample(now)
            _assert_near(before, pose, step)
            before = pose
        machine.request(state, now)
        _assert_near(before, machine.sample(now), 0.0)


def _assert_near(before: Pose, after: Pose, step: float) -> None:
    # Joints swing at up to 6 rad/s here; fades within fades may add as much again, twice over.
    turn = rotations.multiply(after.rotations, rotations.conjugate(before.rotations))
    assert np.abs(rotations.to_rotation_vector(turn)).max() < 30.0 * step + 1e-6
    assert np.abs(after.translations - before.translations).max() < 30.0 * step + 1e-6


def test_a_transition_samples_one_pose_a_frame():
    old, new = Swing(0), Swing(1)
    machine = StateMachine({"a": old, "b": new}, "a")
    machine.request("b", 0.5)
    old.asked = new.asked = 0
    for frame in range(20):
        machine.sample(0.5 + frame / 60)
    assert (old.asked, new.asked) == (0, 20)


def test_a_cross_fade_samples_two_poses_only_while_it_lasts():
    old, new = Swing(0), Swing(1)
    fade = CrossFade(old, new, 0.5, 0.25)
    for time in (0.2, 0.6, 0.9):
        fade.sample(time)
    assert (old.asked, new.asked) == (2, 2)
    assert same(fade.sample(0.5), old.sample(0.5))
    assert same(fade.sample(0.75), new.sample(0.25))
    assert fade.duration == 2.5


@settings(max_examples=examples(40))
@given(st.lists(st.tuples(st.sampled_from("abc"), st.sampled_from([0.0, 0.2])), max_size=4))
def test_a_state_machine_may_cross_fade_between_any_switches(requests):
    states = {name: Swing(seed) for seed, name in enumerate("abc")}
    machine = StateMachine(states, "a")
    now = 0.0
    for state, fade in requests:
        now += 0.09
        before = machine.sample(now)
        machine.request(state, now, crossfade=fade)
        _assert_near(before, machine.sample(now), 0.0)
        parts = machine.travel(now - 0.01, now).then(machine.travel(now, now + 0.02))
        assert parts.z == pytest.approx(machine.travel(now - 0.01, now + 0.02).z)
    now += 0.5
    for motion in states.values():
        motion.asked = 0
    machine.sample(now)
    assert sum(motion.asked for motion in states.values()) == 1


def test_a_cross_fading_state_machine_equals_a_cross_fade():
    machine = StateMachine({"a": Swing(0), "b": Swing(1)}, "a")
    fade = CrossFade(Swing(0), Swing(1), 0.5, 0.25)
    machine.request("b", 0.5, crossfade=0.25)
    for time in (0.4, 0.55, 0.7, 0.9):
        assert same(machine.sample(time), fade.sample(time))
    a, b = machine.travel(0.3, 1.0), fade.travel(0.3, 1.0)
    assert (a.x, a.z, a.yaw) == pytest.approx((b.x, b.z, b.yaw))


def test_a_plane_of_any_motions_blends_what_has_no_phase():
    still = StaticPose(REST, 1.0)
    clip = Clip("c", 10.0, Pose(np.zeros((11, 3, 3)), np.tile(REST.rotations, (11, 1, 1))))
    machine = StateMachine({"a": Swing(1)}, "a")
    space = BlendSpace2D(np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]]), (still, clip, machine))
    blend = space.at([0.3, 0.3])
    assert blend.duration == 1.0
    moved = space.at([0.0, 1.0])  # the machine alone plays by the clock
    assert np.allclose(moved.sample(0.37).rotations, machine.sample(0.37).rotations)
    half = space.at([0.0, 0.5])
    expected = 0.5 * machine.sample(0.37).translations
    assert np.allclose(half.sample(0.37).translations, expected)
