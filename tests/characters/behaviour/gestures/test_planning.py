"""Gestures of whole bodies: places, expressivity, key frames (Huang 2013, sections 8.5 to 8.7)."""

import itertools
import time
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

from cubeling.characters import Character, CharacterWarning
from cubeling.characters.behaviour.expressivity import NEUTRAL, GestureExpressivity
from cubeling.characters.behaviour.gestures.collection import GestureCollection
from cubeling.characters.behaviour.gestures.motion import LIFT_S, SETTLE_S
from cubeling.characters.behaviour.gestures.planning import GesturePlanning, GestureRealizer
from cubeling.characters.behaviour.gestures.timing import PhaseTimes, apex_share, natural_times
from cubeling.characters.behaviour.symbolic_gesture import BodyKey, HandKey, Place, SymbolicGesture
from cubeling.characters.skeleton import rotations
from tests.examples import examples, some

NAMES = ("human", "vleo", "robot")
LOW, HIGH = Place("XC", "YLowerC", "ZMiddle"), Place("XP", "YUpperC", "ZMiddle")
SWING = SymbolicGesture(
    "SWING",
    right=(
        HandKey(0.0, LOW, "flat", "in", "forward"),
        HandKey(0.4, HIGH, "fist", "in", "forward"),
        HandKey(1.0, LOW, "flat", "in", "forward"),
    ),
    body=(BodyKey(0.0), BodyKey(0.4, lean_deg=8.0, turn_deg=10.0), BodyKey(1.0)),
    one_handed=True,
)


@pytest.fixture(scope="module")
def performers():
    return {name: GestureRealizer.of(Character.load(name)) for name in NAMES}


def _strokes(motion, count):
    """Return the poses of the strokes."""
    times = motion.times
    shares = np.linspace(0.0, 1.0, count)
    return [motion.sample(times.in_stroke(float(u)) - times.start) for u in shares]


def _palms(performer, motion, side="right", count=41):
    poses = _strokes(motion, count)
    return np.array([performer.body.palm(pose, side) for pose in poses])


@pytest.mark.parametrize("name", some(NAMES))
def test_every_bundled_gesture_is_performed_by_every_bundled_character(performers, name):
    performer = performers[name]
    for gesture in GestureCollection.load_bundled():
        motion = performer.plan(gesture)
        shown = motion.sample(0.5 * motion.duration).rotations
        assert np.isfinite(shown).all()
        assert np.linalg.norm(shown, axis=1) == pytest.approx(1.0)
        assert np.abs(shown - performer.posture.rotations).max() > 0.01, gesture.name


@pytest.mark.parametrize("left", [False, True])
def test_a_palm_is_where_its_cell_is(performers, left):
    performer = performers["human"]
    place = Place("XP", "YCC", "ZMiddle")
    gesture = SymbolicGesture("HERE", right=(HandKey(0.0, place, "flat", "in", "forward"),))
    motion = performer.plan(replace(gesture, one_handed=True), "left" if left else "right")
    shown = performer.body.palm(_strokes(motion, 1)[0], "left" if left else "right")
    assert np.linalg.norm(shown - performer.space.point(place, left)) < 0.01


ROUNDED = [("human", 6), *[(name, 1) for name in NAMES]]
"""A performer, and of how many gestures one is planned twice."""


@pytest.mark.parametrize(("name", "one_of"), some(ROUNDED))
def test_what_a_processor_rounds_changes_no_posture(performers, name, one_of):
    performer = performers[name]
    turns = performer.posture.rotations
    shares = itertools.cycle((-1e-12, 1e-12))
    gestures = list(GestureCollection.load_bundled())[::one_of]
    for gesture, share in zip(gestures, shares, strict=False):
        posture = replace(performer.posture, rotations=turns * (1.0 + share))
        planned = _key_postures(performer, gesture)
        rounded = _key_postures(replace(performer, posture=posture), gesture)
        assert np.abs(rotations.align(rounded, planned) - planned).max() < 1e-6, gesture.name


def _key_postures(performer, gesture, style=NEUTRAL):
    planning = performer.planning(gesture, "right", style)
    return np.array([planning.turns(number) for number in planning.numbers])


@pytest.mark.parametrize("name", some(NAMES))
def test_hands_are_in_their_key_postures_on_time(performers, name):
    performer = performers[name]
    motion, planning = performer.plan(SWING), performer.planning(SWING)
    for key in planning.keys_of_strokes:
        pose = motion.sample(motion.times.in_stroke(key.share))
        planned = planning.turns(key.number)[: len(planning.joints.arms)]
        shown = rotations.align(pose.rotations[planning.joints.arms], planned)
        assert shown == pytest.approx(planned, abs=1e-9)
    assert {0.0, 0.4, 1.0} <= {key.share for key in planning.keys_of_strokes}


def test_hands_pass_the_first_key_go_beyond_the_last_one_and_settle(performers):
    performer = performers["human"]
    keys = (SWING.right[0], replace(SWING.right[1], at=1.0))
    motion = performer.plan(replace(SWING, right=keys, body=(), hold=1.0))
    times = motion.times
    spans = np.linspace(times.ready, times.relax, 200)
    heights = np.array([performer.body.palm(motion.sample(t), "right")[1] for t in spans])
    arrived = np.searchsorted(spans, times.stroke_end)
    assert heights[arrived:].max() > heights[arrived] + 0.002
    still = (spans > times.stroke_end + SETTLE_S) & (spans < times.relax - LIFT_S)
    assert np.ptp(heights[still]) < 1e-9
    step = 1e-3
    before, at, after = (
        performer.body.palm(motion.sample(times.ready + t), "right") for t in (-step, 0.0, step)
    )
    speeds = (at - before) / step, (after - at) / step
    assert np.linalg.norm(speeds[0]) > 0.1
    assert speeds[0] == pytest.approx(speeds[1], abs=0.05)


def test_what_a_hand_touches_stops_it(performers):
    performer = performers["human"]
    think = GestureCollection.load_bundled().get("THINK")
    motion = performer.plan(replace(think, hold=1.0), expressivity=GestureExpressivity(bias=1.0))
    times = motion.times
    places = [
        performer.body.palm(motion.sample(t), "right")
        for t in np.linspace(times.stroke_end, times.relax, 50)
    ]
    assert np.ptp(places, axis=0).max() < 0.002


def test_wrist_and_fingers_trail_the_arm(performers):
    planning = GesturePlanning(performers["human"], SWING, "right", NEUTRAL)
    times = PhaseTimes(natural_times(SWING), apex_share(SWING), SWING.retraction)
    joints, moments = planning.joints, np.array([0.0, 0.2, 0.25, 0.5])
    trailing = planning.motion(times)
    planning.joints = replace(joints, lags=np.zeros_like(joints.lags))
    at_once = planning.motion(times)

    def turns(motion, time):
        return motion.sample(time).rotations[joints.arms]

    late = joints.lags[: len(joints.arms)] > 0.0
    for moment in moments:
        apart = np.abs(np.vecdot(turns(trailing, moment), turns(at_once, moment)))
        assert apart[~late] == pytest.approx(1.0)
        assert apart[late] == pytest.approx(1.0) or moment not in (0.0, 0.5)
    lag = joints.lags.max()
    behind = np.abs(np.vecdot(turns(trailing, 0.25), turns(at_once, 0.25 - lag)))
    assert behind[joints.lags[: len(joints.arms)] == lag] == pytest.approx(1.0, abs=1e-4)


def test_a_hand_on_the_other_side_is_the_mirror_image(performers):
    performer = performers["human"]
    right = _palms(performer, performer.plan(SWING, "right"), "right")
    left = _palms(performer, performer.plan(SWING, "left"), "left")
    chest = performer.space.chest  # its idle posture stands on one leg
    assert np.abs((right - chest) * [-1.0, 1.0, 1.0] - (left - chest)).max() < 0.02


def test_hands_that_meet_meet(performers):
    performer = performers["human"]
    motion = performer.plan(GestureCollection.load_bundled().get("CLAP"))
    gap = np.linalg.norm(
        _palms(performer, motion, "left", 201) - _palms(performer, motion, "right", 201), axis=1
    )
    assert gap.min() < 0.02
    assert gap.max() > 0.1


@pytest.mark.parametrize("name", NAMES)
def test_more_space_means_farther_keys_and_a_larger_sweep(performers, name):
    performer = performers[name]
    sweeps = []
    for spatial in (-0.5, -0.2, 0.1):
        motion = performer.plan(SWING, expressivity=GestureExpressivity(spatial=spatial))
        sweeps.append(np.ptp(_palms(performer, motion), axis=0).max())
    assert sweeps == sorted(sweeps)
    assert sweeps[2] > 1.2 * sweeps[0]


def _trunk_turn(performer, motion):
    chest = performer.chest
    skeleton = performer.character.skeleton
    poses = _strokes(motion, 41)
    turns = rotations.from_matrix(np.array([p.globals(skeleton)[chest, :3, :3] for p in poses]))
    start = rotations.from_matrix(performer.posture.globals(skeleton)[chest, :3, :3])
    away = rotations.multiply(turns, rotations.conjugate(start))
    return np.linalg.norm(rotations.to_rotation_vector(away), axis=1).max()


def test_more_power_means_a_larger_torso_movement_and_a_higher_peak_speed(performers):
    performer = performers["human"]
    turns, speeds = [], []
    for power in (0.0, 0.5, 1.0):
        motion = performer.plan(SWING, expressivity=GestureExpressivity(power=power))
        turns.append(_trunk_turn(performer, motion))
        steps = np.diff(_palms(performer, motion, count=201), axis=0)
        speeds.append(np.linalg.norm(steps, axis=1).max())
    assert turns == sorted(turns)
    assert turns[2] > 1.5 * turns[0]
    assert speeds == sorted(speeds)
    assert speeds[2] > 1.5 * speeds[0]


def test_an_open_posture_moves_the_elbow_and_not_the_wrist(performers):
    performer = performers["human"]
    arm = performer.body.arms["right"]
    elbows, wrists = [], []
    for openness in (0.0, 0.25, 0.5, 0.75, 1.0):
        motion = performer.plan(SWING, expressivity=GestureExpressivity(openness=openness))
        placed = _strokes(motion, 1)[0].globals(performer.character.skeleton)
        chest = placed[performer.chest, :3, 3]
        elbow, wrist = placed[arm.joints[2], :3, 3], placed[arm.joints[3], :3, 3]
        elbows.append(np.linalg.norm((elbow - chest)[[0, 2]]))
        wrists.append(wrist)
    assert (np.diff(elbows) > 0.0).all()
    assert np.ptp(wrists, axis=0).max() < 0.02  # the torso opens too; reaching tests hold it still


def test_power_overshoots_in_rotation_and_comes_back(performers):
    keys = tuple(replace(key, path="line") for key in SWING.right[:2])
    thrust = replace(SWING, right=(keys[0], replace(keys[1], at=1.0)), body=())
    performer = performers["human"]
    motion = performer.plan(thrust, expressivity=GestureExpressivity(power=1.0))
    heights = _palms(performer, motion, count=201)[:, 1]
    assert heights.max() > heights[-1] + 0.005
    calm = _palms(performer, performer.plan(thrust), count=201)[:, 1]
    assert calm.max() < calm[-1] + 0.001


def test_repeated_strokes_are_the_same_and_the_apex_is_that_of_the_first(performers):
    clap = GestureCollection.load_bundled().get("CLAP")
    motion = performers["human"].plan(clap)
    apex = apex_share(clap)
    first, second = (
        motion.sample(motion.times.in_stroke(each)).rotations for each in (apex, apex + 1.0 / 5.0)
    )
    assert second == pytest.approx(first)
    assert apex_share(clap) == pytest.approx(clap.apex / clap.repeats)


def test_an_open_stroke_goes_back_before_it_is_repeated(performers):
    tap = replace(SWING, right=(SWING.right[0], replace(SWING.right[1], at=1.0)), repeats=3)
    performer = performers["human"]
    heights = _palms(performer, performer.plan(tap), count=301)[:, 1]
    assert np.abs(np.diff(heights)).max() < 0.05
    peaks = np.flatnonzero((np.diff(heights[:-1]) > 0.0) & (np.diff(heights[1:]) <= 0.0))
    assert len(peaks) >= 2


def test_without_arms_the_rest_of_the_body_performs_and_says_so(actor):
    performer = GestureRealizer.of(actor)
    with pytest.warns(CharacterWarning, match="without its right arm"):
        motion = performer.plan(SWING)
    assert np.isfinite(motion.sample(0.1).rotations).all()


@pytest.mark.parametrize("keys", [(), (HandKey(0.5),)])
def test_a_gesture_of_the_body_or_of_one_key_is_held(performers, keys):
    gesture = SymbolicGesture("HELD", right=keys, body=(BodyKey(0.3, lean_deg=10.0),))
    motion = performers["human"].plan(gesture)
    first, last = (pose.rotations for pose in _strokes(motion, 2))
    assert first == pytest.approx(last, abs=1e-4)


def test_a_frame_takes_less_than_a_millisecond(performers):
    performer = performers["human"]
    motion = performer.plan(GestureCollection.load_bundled().get("OPEN_ARMS"))
    spans = []
    for _ in range(50):
        start = time.perf_counter()
        motion.over(performer.posture, motion.times.in_stroke(0.37), 0.5)
        spans.append(time.perf_counter() - start)
    assert min(spans) < 1e-3


def test_a_plan_made_bit_by_bit_is_the_plan_made_at_once(performers):
    wave = GestureCollection.load_bundled().get("WAVE")
    style = GestureExpressivity(spatial=0.123)
    planning = performers["human"].planning(wave, "right", style)
    for _ in range(10):
        planning.advance(2)
    again = GesturePlanning(performers["human"], wave, "right", style)
    for number in reversed(planning.numbers):
        assert planning.turns(number) == pytest.approx(again.turns(number))


@given(st.lists(st.floats(-1.0, 1.0), min_size=6, max_size=6))
@settings(max_examples=examples(25))
def test_every_style_gives_finite_postures(performers, values):
    style = GestureExpressivity(*values)
    motion = performers["human"].plan(SWING, "both", style)
    poses = [motion.sample(motion.duration * u) for u in (0.1, 0.3, 0.5, 0.8)]
    assert np.isfinite([pose.rotations for pose in poses]).all()
