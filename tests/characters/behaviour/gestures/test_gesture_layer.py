"""Gestures in the frames of an animator: on time, without jumps, with the free hand."""

from copy import copy
from dataclasses import replace

import numpy as np
import pytest

from cubeling.characters import ActionIntent, Animator, Character, CharacterCommand
from cubeling.characters.behaviour.gestures.collection import GestureCollection
from cubeling.characters.behaviour.gestures.planning import GesturePlanning, GestureRealizer
from cubeling.characters.behaviour.gestures.timing import PhaseTimes, natural_times
from cubeling.characters.behaviour.intents import BehaviourIntent, GestureIntent, ReachIntent, Times
from cubeling.characters.behaviour.symbolic_gesture import HandKey, Place, SymbolicGesture
from cubeling.characters.control.layers.gestures.layer import SHOWN_AT_ONCE, GestureLayer
from cubeling.characters.control.layers.gestures.playback import GesturePlayback
from cubeling.characters.control.layers.gestures.sitting_up import SittingUpLayer
from tests.examples import some

RATE = 30.0
MAX_STEP_DEG = 25.0
"""Turn of a joint in a frame that is no jump: a fast wave."""

HURRIED_STEP_DEG = 45.0
"""The same if the stroke is asked for 0.3 s sooner and at once: it is there 0.1 s later."""

LOW, HIGH = Place("XC", "YLowerC", "ZMiddle"), Place("XP", "YUpperP", "ZMiddle")
LIFT = SymbolicGesture(
    "LIFT",
    right=(
        HandKey(0.0, LOW, "flat", "in", "forward"),
        HandKey(0.5, HIGH, "flat", "in", "forward"),
        HandKey(1.0, LOW, "flat", "in", "forward"),
    ),
    one_handed=True,
    apex=0.5,
)


@pytest.fixture(scope="module")
def characters():
    """Return the bundled characters without clips of walking, which take a while to measure."""
    loaded = {name: Character.load(name) for name in ("human", "vleo", "robot")}
    return {
        name: replace(each, clips={k: v for k, v in each.clips.items() if k in ("idle", "cheer")})
        for name, each in loaded.items()
    }


@pytest.fixture(scope="module")
def human(characters):
    return characters["human"]


@pytest.fixture(scope="module")
def performer(human):
    return GestureRealizer.of(human)


def _play(character, behaviour_at, end, **kw):
    """Return the poses of an animator without idle life."""
    animator = Animator(character, layers=(SittingUpLayer, GestureLayer))
    times = np.arange(0.0, end, 1.0 / RATE)
    return times, [
        animator.update(CharacterCommand(float(t), behaviour=behaviour_at(float(t)), **kw)).pose
        for t in times
    ]


def _asked(gesture, times, hand="right", key="g", start=-1.0, end=99.0):
    def at(now):
        intent = GestureIntent(key, gesture, times, hand)
        return BehaviourIntent((intent,)) if start <= now < end else None

    return at


def _largest_step(poses):
    turns = np.array([pose.rotations for pose in poses])
    cosines = np.abs((turns[1:] * turns[:-1]).sum(axis=-1))
    return np.degrees(2.0 * np.arccos(np.clip(cosines, 0.0, 1.0))).max()


def _heights(performer, poses, side="right"):
    return np.array([performer.body.palm(pose, side)[1] for pose in poses])


def test_the_apex_is_at_the_time_of_the_stroke(human, performer):
    times = replace(natural_times(LIFT, 0.5), stroke_start=1.4, stroke=2.0, stroke_end=2.3)
    times = replace(times, relax=2.6, end=3.2)
    shown, poses = _play(human, _asked(LIFT, times), 3.5)
    heights = _heights(performer, poses)
    assert shown[heights.argmax()] == pytest.approx(2.0, abs=1.0 / RATE)
    held = heights[(shown >= 1.05) & (shown <= 1.4)]
    assert np.ptp(held) < 0.01
    assert _largest_step(poses) < MAX_STEP_DEG


def test_hands_start_from_the_pose_below_and_return_to_it(human):
    _, poses = _play(human, _asked(LIFT, natural_times(LIFT, 0.5)), 2.6)
    _, bare = _play(human, lambda now: None, 2.6)
    for frame in (0, 14, -1):
        assert poses[frame].rotations == pytest.approx(bare[frame].rotations, abs=1e-9)
    assert np.abs(poses[30].rotations - bare[30].rotations).max() > 0.1


LATER = [(when, shift) for when in (0.7, 1.2, 1.6) for shift in (-0.3, -0.1, 0.2, 1.0)]


@pytest.mark.parametrize(("when", "shift"), some(dict.fromkeys([*LATER[::5], *LATER]), 3))
def test_new_times_are_followed_without_a_jump(human, performer, shift, when):
    before = natural_times(LIFT, 0.5)
    moved = [
        getattr(before, name) + shift for name in ("ready", "stroke_start", "stroke", "stroke_end")
    ]
    ready, start, stroke, end = (max(each, when) for each in moved)
    after = replace(before, ready=ready, stroke_start=start, stroke=stroke, stroke_end=end)
    after = replace(after, relax=end + 0.2, end=end + 0.8)

    def asked(now):
        return BehaviourIntent((GestureIntent("g", LIFT, before if now < when else after),))

    shown, poses = _play(human, asked, end + 1.0)
    hurried = shift < 0.0 and stroke - when < 0.31
    assert _largest_step(poses) < (HURRIED_STEP_DEG if hurried else MAX_STEP_DEG)
    if stroke > when + 0.1 and when < before.stroke - 0.1:
        peak = shown[_heights(performer, poses).argmax()]
        assert peak == pytest.approx(stroke, abs=1.01 / RATE)


@pytest.mark.parametrize("when", some([0.6, 1.0, 1.3]))
def test_one_that_is_left_out_goes_as_gently_as_it_came(human, when):
    times = natural_times(LIFT, 0.3)
    shown, poses = _play(human, _asked(LIFT, times, end=when), when + 1.2)
    _, whole = _play(human, _asked(LIFT, times), 2.6)
    _, bare = _play(human, lambda now: None, when + 1.2)
    assert _largest_step(poses) < 1.2 * _largest_step(whole)
    gone = int(np.searchsorted(shown, when + 1.0))
    assert poses[gone].rotations == pytest.approx(bare[gone].rotations, abs=1e-9)


def test_one_whose_strokes_are_to_be_over_is_called_off_as_gently(human):
    """So is one that waits for the cube, when the cube is there before the hand is up."""
    times = natural_times(LIFT, 0.3)
    now = times.ready - 0.3
    strokes = dict.fromkeys(("ready", "stroke_start", "stroke", "stroke_end", "relax"), now)
    over = replace(times, **strokes, end=now + 0.5)

    def asked(time):
        return BehaviourIntent((GestureIntent("g", LIFT, times if time < now else over),))

    _, poses = _play(human, asked, now + 0.5)
    _, whole = _play(human, _asked(LIFT, times), 2.6)
    assert _largest_step(poses) < 1.2 * _largest_step(whole)


def test_one_that_is_left_out_stops_at_once(human):
    """Hands in the middle of a stroke do not finish it."""
    times = natural_times(LIFT, 0.3)
    playback = GesturePlayback(
        GestureIntent("g", LIFT, times), "right", GestureRealizer.of(human), 1.0
    )
    rest = human.clips["idle"].sample(0.0)
    now = times.stroke_start + 0.05
    for frame in range(3):
        playback.over(rest, now + frame / RATE, 1.0)
    now += 3 / RATE
    playback.give_up(now, 1 / RATE)
    stopped = playback.moment(now)
    assert playback.moment(now + 0.1) - stopped < 0.08
    assert playback.moment(now + 5.0) - playback.moment(now + 0.3) < 0.01


def test_one_that_is_heard_of_late_joins_in(human):
    times = natural_times(LIFT, 0.0)
    _, poses = _play(human, _asked(LIFT, times, start=0.6), 1.5)
    assert _largest_step(poses) < MAX_STEP_DEG


def test_without_an_end_the_stroke_is_held(human, performer):
    times = replace(natural_times(LIFT, 0.2), relax=None, end=None)
    shown, poses = _play(human, _asked(LIFT, times), 6.0)
    held = _heights(performer, poses)[shown > times.stroke_end + 0.1]
    assert np.ptp(held) < 0.02


@pytest.mark.parametrize(
    ("hand", "moves"), [("left", "left"), ("right", "right"), ("both", "both")]
)
def test_either_hand_performs_a_one_handed_gesture(human, performer, hand, moves):
    _, poses = _play(human, _asked(LIFT, natural_times(LIFT, 0.2), hand), 1.5)
    for side in ("left", "right"):
        lifted = np.ptp(_heights(performer, poses, side)) > 0.2
        assert lifted == (moves in (side, "both"))


def test_the_nearest_hand_is_the_one_that_is_free(human, performer):
    reach = ReachIntent("r", np.array([0.0, 0.1, 0.1]), Times(0.0, 0.5), hand="right")
    gesture = GestureIntent("g", LIFT, natural_times(LIFT, 0.2), "nearest")
    _, poses = _play(human, lambda now: BehaviourIntent((gesture,), (reach,)), 1.5)
    assert np.ptp(_heights(performer, poses, "left")) > 0.2
    assert np.ptp(_heights(performer, poses, "right")) < 0.1


def test_hands_are_not_free_in_an_action(human):
    times = natural_times(LIFT, 0.5)
    acting = ActionIntent("cheer")
    _, poses = _play(human, _asked(LIFT, times), 1.5, action=acting)
    _, bare = _play(human, lambda now: None, 1.5, action=acting)
    assert poses[-1].rotations == pytest.approx(bare[-1].rotations, abs=0.01)


def test_two_gestures_of_two_hands_are_performed_at_once(human, performer):
    first = GestureIntent("a", LIFT, natural_times(LIFT, 0.2), "right")
    second = GestureIntent("b", LIFT, natural_times(LIFT, 0.4), "left")
    _, poses = _play(human, lambda now: BehaviourIntent((first, second)), 2.0)
    for side in ("left", "right"):
        assert np.ptp(_heights(performer, poses, side)) > 0.2


def test_a_gesture_goes_on_from_the_one_before(human, performer):
    held = replace(LIFT, right=LIFT.right[:2], apex=1.0, stroke=0.6)
    up = replace(natural_times(held, 0.2), relax=1.5, end=2.1)
    next_times = natural_times(held, 1.55)
    one, other = (
        GestureIntent("a", held, up),
        GestureIntent("b", replace(held, name="B"), next_times),
    )
    shown, poses = _play(human, lambda now: BehaviourIntent((one, other)), 2.6)
    heights = _heights(performer, poses)
    between = (shown > up.stroke_end) & (shown < next_times.stroke_end)
    hanging = heights[0]
    # It comes down to its own first key, and not to rest.
    low = heights[(shown >= next_times.ready) & (shown < next_times.ready + 0.05)].min()
    assert heights[between].min() > low - 0.1 * (low - hanging)
    assert _largest_step(poses) < MAX_STEP_DEG


def _all_of(count, starts, ends):
    """Return what asks for `count` gestures that differ, each from its start to its end."""
    intents = [
        GestureIntent(f"g{i}", replace(LIFT, name=f"LIFT{i}"), natural_times(LIFT, start))
        for i, start in zip(range(count), starts, strict=True)
    ]

    def at(now):
        asked = (each for each, end in zip(intents, ends, strict=True) if now < end)
        return BehaviourIntent(tuple(asked))

    return at


def test_of_many_gestures_at_once_the_last_few_are_planned(human, monkeypatch):
    planned, motion = [], GesturePlanning.motion

    def counted(*of):
        planned.append(of[0])
        return motion(*of)

    monkeypatch.setattr(GesturePlanning, "motion", counted)
    _play(human, _all_of(60, [0.1] * 60, [99.0] * 60), 0.4)
    assert len(planned) == SHOWN_AT_ONCE


def test_a_gesture_that_later_ones_cover_goes_and_comes_back_without_a_jump(human):
    starts, ends = [0.1, *[0.5] * 6], [99.0, *[0.9] * 6]
    _, poses = _play(human, _all_of(7, starts, ends), 1.6)
    _, alone = _play(human, _all_of(1, [0.1], [99.0]), 1.6)
    assert _largest_step(poses) < MAX_STEP_DEG
    np.testing.assert_allclose(poses[-1].rotations, alone[-1].rotations, atol=1e-6)


def test_a_body_with_one_arm_performs_with_that_one(human):
    realizer = GestureRealizer.of(human)
    one_arm = replace(realizer, body=copy(realizer.body))
    one_arm.body.arms = {"left": realizer.body.arms["left"]}
    assert set(one_arm.planning(LIFT, "right").keys) == {"left"}


GESTURES = "CLAP", "WAVE", "THINK", "BOW", "FIST_PUMP"
SHOWN = [("human", "CLAP"), ("vleo", "WAVE"), ("robot", "FIST_PUMP"), ("human", "BOW")]
SHOWN += [(name, gesture) for gesture in GESTURES for name in ("human", "vleo", "robot")]


@pytest.mark.parametrize(("name", "gesture"), some(dict.fromkeys(SHOWN), 4))
def test_gestures_have_no_jumps_on_any_character(characters, name, gesture):
    symbolic = GestureCollection.load_bundled().get(gesture)
    times = natural_times(symbolic, 0.5)
    _, poses = _play(characters[name], _asked(symbolic, times), (times.end or 0.0) + 0.3)
    assert _largest_step(poses) < 45.0


def test_a_character_without_arms_goes_on(actor):
    with pytest.warns(match="without its right arm"):
        _, poses = _play(actor, _asked(LIFT, natural_times(LIFT, 0.1)), 1.0)
    assert all(np.isfinite(pose.rotations).all() for pose in poses)


def test_phases_without_length_are_passed():
    natural = PhaseTimes(natural_times(LIFT, 1.0), 0.5, 0.6)
    at_once = PhaseTimes(replace(natural_times(LIFT, 1.0), ready=1.0, stroke_start=1.0), 0.5, 0.6)
    assert at_once.at(0.99, natural) == natural.start
    assert at_once.at(1.0 + 1e-3, natural) >= natural.ready
