"""Every motion nests in every other, whatever it is."""

import math

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

from cubeling.characters import (
    Action,
    AdditiveLayer,
    Blend,
    BlendSpace1D,
    BlendSpace2D,
    CharacterError,
    Clip,
    CrossFade,
    FadeCurve,
    LiveSchedule,
    Loop,
    MaskedLayer,
    Mirror,
    Mirrored,
    Motion,
    Pose,
    RootDelta,
    RootOffset,
    Schedule,
    Skeleton,
    StateMachine,
    Stretch,
    TimeCurve,
    TimeWindow,
    Warped,
    mask_of,
)
from cubeling.characters.motion.blend import TimeScaled
from cubeling.characters.motion.phase import PhasedMotion, RetimedMotion, StaticPose, as_cyclic
from cubeling.characters.skeleton import rotations
from tests.examples import examples

NAMES = ("root", "spine", "LeftArm", "RightArm", "LeftHand", "RightHand")
REST = Pose(
    np.array(
        [[0, 0, 0], [0, 1, 0], [0.3, 0.3, 0], [-0.3, 0.3, 0], [0.2, 0, 0], [-0.2, 0, 0]], float
    ),
    np.tile(rotations.IDENTITY, (6, 1)),
)
SKELETON = Skeleton(NAMES, (-1, 0, 1, 1, 2, 3), REST)
MIRROR = Mirror.of(SKELETON, ("happy", "blinkLeft", "blinkRight"))
UPPER = mask_of(SKELETON, {"spine": 1.0}, {"spine": 0.5})
FRAMES, RATE = 9, 8.0


def arc(seed: int) -> Clip:
    """A loop along an arc at constant velocity, with limbs and morphs that swing."""
    rng = np.random.default_rng(seed)
    phase = np.linspace(0, 2 * np.pi, FRAMES)[:, None, None]
    turns = rotations.from_rotation_vector(
        rng.uniform(-0.8, 0.8, (6, 3)) * np.sin(phase + rng.uniform(0, 6, (6, 1)))
    )
    shifts = np.tile(REST.translations, (FRAMES, 1, 1))
    speed, spin = rng.uniform(0.2, 2.0), rng.uniform(-1.0, 1.0)
    yaw = spin * np.arange(FRAMES) / RATE
    turns[:, 0] = rotations.about("y", yaw)
    shifts[:, 0, 0] = speed / spin * (1 - np.cos(yaw))
    shifts[:, 0, 2] = speed / spin * np.sin(yaw)
    looks = 0.5 + 0.5 * np.sin(phase[:, 0] + np.arange(3))
    return Clip(f"arc {seed}", RATE, Pose(shifts, turns, None, looks), True, True)


CLIPS = [arc(seed) for seed in range(4)]
clips = st.sampled_from(CLIPS)
leaves = st.one_of(
    clips,
    clips.map(lambda clip: PhasedMotion(clip, (0.2, 0.7))),
    st.just(StaticPose(REST, 1.0)),
    clips.map(lambda clip: Clip("once", RATE, clip.poses, False, True)),
)
unit, times = st.floats(0.05, 0.95), st.floats(0.0, 3.0)


def machine(first: Motion, second: Motion, at: float) -> StateMachine:
    states = StateMachine({"a": first, "b": second}, "a")
    states.request("b", at)
    return states


def finite(motion: Motion) -> Motion:
    return motion if math.isfinite(motion.duration) else TimeWindow(motion, 0.0, 1.5)


def nested(inner: st.SearchStrategy[Motion]) -> st.SearchStrategy[Motion]:
    pair, fades = st.tuples(inner, inner), st.builds(FadeCurve, unit, unit)
    weights = st.one_of(unit, fades)
    masks = st.sampled_from([None, UPPER, 1.0 - UPPER])
    actions = st.builds(
        Action,
        inner,
        start=times,
        weight=weights,
        mask=masks,
        scale=st.sampled_from([1.0, 0.5]),
        always=st.booleans(),
    )
    return st.one_of(
        st.builds(lambda m, d: Stretch(finite(m), d), inner, st.floats(0.3, 3.0)),
        st.builds(lambda m, a, d: TimeWindow(m, a, a + d), inner, times, unit),
        inner.map(lambda m: Loop(finite(m))),
        inner.map(lambda m: Mirrored(m, MIRROR)),
        st.builds(lambda m, x, yaw: RootOffset(m, RootDelta(x, 1.0, yaw)), inner, unit, unit),
        inner.map(lambda m: Warped(m, TimeCurve((0.0, 1.0, 2.0), (0.2, 0.8, 3.0)))),
        st.builds(lambda p, w: Blend(p, (w, 1 - w)), pair, unit),
        st.builds(lambda p, w: BlendSpace1D((0.0, 1.0), p).at(w), pair, unit),
        st.builds(
            lambda p, x, z: BlendSpace2D(np.array([[0.0, 0.0], [1.0, 0.5]]), p).at((x, z)),
            pair,
            unit,
            unit,
        ),
        st.builds(lambda m, r: TimeScaled(as_cyclic(finite(m)), r), inner, st.floats(0.5, 2.0)),
        inner.map(lambda m: RetimedMotion(as_cyclic(finite(m)), 0.3)),
        st.builds(lambda p, k, w: MaskedLayer(p[0], p[1], mask=k, weight=w), pair, masks, weights),
        st.builds(
            lambda p, k, w: AdditiveLayer(p[0], p[1], mask=k, weight=w), pair, masks, weights
        ),
        st.builds(lambda p, t, d: CrossFade(p[0], p[1], t, d), pair, times, unit),
        st.builds(lambda p, t: machine(p[0], p[1], t), pair, times),
        st.lists(actions, max_size=3).map(lambda a: Schedule(tuple(a), REST)),
        st.lists(actions, max_size=2).map(lambda a: LiveSchedule(Schedule(tuple(a), REST))),
    )


trees = st.recursive(leaves, nested, max_leaves=5)


@settings(max_examples=examples(150))
@given(trees, times)
def test_any_tree_of_motions_gives_the_same_poses_again(motion, time):
    assert isinstance(motion, Motion)
    assert motion.duration >= 0.0
    pose, again = motion.sample(time), motion.sample(time)
    assert pose.translations.shape == (6, 3)
    assert pose.rotations.shape == (6, 4)
    assert np.isfinite(pose.translations).all()
    assert np.linalg.norm(pose.rotations, axis=-1) == pytest.approx(1.0, abs=1e-9)
    assert pose.morphs is None or (pose.morphs.shape == (3,) and np.isfinite(pose.morphs).all())
    assert np.array_equal(pose.rotations, again.rotations)
    assert np.array_equal(pose.translations, again.translations)


@settings(max_examples=examples(100))
@given(trees, st.lists(times, min_size=3, max_size=3))
def test_deltas_of_parts_compose_to_the_delta_of_the_whole(motion, at):
    start, middle, end = sorted(at)
    whole = motion.travel(start, end)
    parts = motion.travel(start, middle).then(motion.travel(middle, end))
    # Mixed steps are means over an interval, and exact where their members move evenly.
    slack = 0.02 * (1.0 + end - start)
    assert (parts.x, parts.z, parts.yaw) == pytest.approx((whole.x, whole.z, whole.yaw), abs=slack)
    assert (
        motion.travel(middle, middle) == RootDelta() or motion.travel(middle, middle).length < 1e-12
    )


@given(st.lists(unit, min_size=4, max_size=4), st.lists(times, min_size=3, max_size=3))
def test_blends_of_arcs_are_arcs(weights, at):
    start, middle, end = sorted(at)
    total = sum(weights)
    blend = Blend(tuple(CLIPS), tuple(w / total for w in weights))
    parts = blend.travel(start, middle).then(blend.travel(middle, end))
    whole = blend.travel(start, end)
    # The root's track is straight between frames: an arc of chords.
    assert (parts.x, parts.z, parts.yaw) == pytest.approx((whole.x, whole.z, whole.yaw), abs=1e-3)


def test_a_loop_continues_from_its_end():
    once = Clip("once", RATE, CLIPS[0].poses, False, True)
    loop, clip = Loop(once), CLIPS[0]
    for start, end in ((0.0, 0.5), (0.3, 4.7), (1.0, 2.0)):
        a, b = loop.travel(start, end), clip.travel(start, end)
        assert (a.x, a.z, a.yaw) == pytest.approx((b.x, b.z, b.yaw))
    assert np.allclose(loop.sample(2.3).rotations, clip.sample(2.3).rotations)


def test_stretch_window_and_warp_address_the_same_times():
    clip = CLIPS[1]
    cut = Stretch(TimeWindow(clip, 0.25, 0.75), 5.0)  # the specification's window and stretch
    warp = Warped(clip, TimeCurve((0.0, 5.0), (0.25, 0.75)))
    assert cut.duration == warp.duration == 5.0
    for time in (0.0, 1.7, 5.0, 6.0):
        assert np.allclose(cut.sample(time).rotations, warp.sample(time).rotations)
    assert np.allclose(cut.sample(2.5).rotations, clip.sample(0.5).rotations)
    a, b = cut.travel(0.0, 5.0), clip.travel(0.25, 0.75)
    assert (a.x, a.z) == pytest.approx((b.x, b.z))


def test_time_may_run_backwards():
    clip = CLIPS[2]
    back = Warped(clip, TimeCurve((0.0, 1.0), (1.0, 0.0)))
    assert np.allclose(back.sample(0.25).rotations, clip.sample(0.75).rotations)
    there = clip.travel(0.0, 1.0).then(back.travel(0.0, 1.0))
    assert (there.length, there.yaw) == pytest.approx((0.0, 0.0), abs=1e-9)


def test_a_root_offset_moves_the_whole_motion():
    clip, step = CLIPS[0], RootDelta(2.0, -1.0, 0.7)
    moved = RootOffset(clip, step)

    def placed(motion: Motion, time: float) -> RootDelta:
        pose, way = motion.sample(time), motion.travel(0.0, time)
        x, _, z = pose.translations[0]
        return way.then(RootDelta(x, z, float(rotations.heading(pose.rotations[0]))))

    for time in (0.0, 0.4, 1.3):
        a, b = placed(moved, time), step.then(placed(clip, time))
        assert (a.x, a.z, math.cos(a.yaw)) == pytest.approx((b.x, b.z, math.cos(b.yaw)))


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: Stretch(CLIPS[0], 0.0), "stretch to 0.0 s"),
        (lambda: Loop(LiveSchedule(Schedule((), REST))), "has no end; take a TimeWindow"),
        (lambda: TimeWindow(CLIPS[0], 1.0, 0.5), "a later end"),
        (lambda: TimeCurve((0.0, 0.0), (0.0, 1.0)), "times ascending"),
        (lambda: TimeCurve((0.0, math.nan), (0.0, 1.0)), "time curve"),
        (lambda: Blend((CLIPS[0],), (0.7,)), "sum one"),
        (lambda: Blend((CLIPS[0], CLIPS[1]), (-0.5, 1.5)), "none negative"),
        (lambda: Blend((CLIPS[0],), (math.nan,)), "sum one"),
        (lambda: Blend((), ()), "0 motions"),
        (lambda: BlendSpace1D((0.0, 1.0), (CLIPS[0],) * 2).at(math.nan), "a value of nan"),
        (lambda: BlendSpace2D(np.eye(2), (CLIPS[0],) * 2).at((0.0, math.inf)), "inf"),
        (lambda: MaskedLayer(CLIPS[0], CLIPS[1], weight=1.5), "give 0 to 1"),
        (lambda: MaskedLayer(CLIPS[0], CLIPS[1], mask=np.full(6, 2.0)), "one weight 0…1"),
        (
            lambda: MaskedLayer(CLIPS[0], CLIPS[1], mask=np.ones(5)).sample(0.0),
            "5 joints on a pose",
        ),
        (lambda: AdditiveLayer(CLIPS[0], CLIPS[1], weight=math.nan), "finite"),
        (lambda: CrossFade(CLIPS[0], CLIPS[1], 0.0, 0.0), "positive length"),
        (lambda: mask_of(SKELETON, {"tail": 1.0}), "no joint 'tail'"),
        (lambda: mask_of(SKELETON, {"spine": -1.0}), "give 0 to 1"),
        (lambda: Action(CLIPS[0], weight=-1.0), "give 0 or more"),
    ],
)
def test_invalid_motions_are_refused_in_one_line(make, message):
    with pytest.raises(CharacterError, match=message) as refused:
        make()
    assert "\n" not in str(refused.value)
