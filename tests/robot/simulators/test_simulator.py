"""The simulated robot moves, feels and tires as a real one of its kind must."""

import numpy as np
import pytest
from hypothesis import given, strategies as st

from cubeling.affect import Emotion
from cubeling.robot.protocol import messages as m
from cubeling.robot.simulators.cubeling import dinosaur
from cubeling.robot.simulators.cubeling.body import MAX_EMOTION_SPEED, STEP_S, Battery, DinosaurBody

MOODS = {"happy": Emotion(0.9, 0.9), "neutral": Emotion(0, 0), "angry": Emotion(-0.9, 0.9)}


def live(body: DinosaurBody, start: float, seconds: float) -> np.ndarray:
    """Live, and return the true angles at every step, (steps, joints) [rad]."""
    angles = []
    for step in range(round(seconds / STEP_S)):
        body.advance(start + (step + 1) * STEP_S + 1e-6)
        angles.append(body.angles)
    return np.array(angles)


def body_at(seed: int = 0) -> DinosaurBody:
    body = DinosaurBody(seed)
    body.advance(0.0)
    return body


@given(
    st.lists(
        st.one_of(
            st.tuples(st.floats(-1, 1), st.floats(-1, 1)).map(lambda pair: ("express", pair)),
            st.integers(0, len(dinosaur.MOTIONS) - 1).map(lambda index: ("play", index)),
            st.just(("stop", 0)),
            st.just(("neutral", 0)),
        ),
        max_size=6,
    )
)
def test_no_joint_leaves_its_limits_or_turns_faster_than_it_can(requests):
    body, now, before = body_at(), 0.0, np.zeros(14)
    for name, value in requests:
        match name:
            case "express":
                body.express(Emotion(*value))
            case "play":
                body.play(m.ITEM_MOTION, value)
            case _:
                getattr(body, name)()
        angles = np.vstack([before, live(body, now, 0.6)])
        now, before = now + 0.6, angles[-1]
        assert (angles >= dinosaur.MIN_ANGLES_RAD - 1e-12).all()
        assert (angles <= dinosaur.MAX_ANGLES_RAD + 1e-12).all()
        assert (
            np.abs(np.diff(angles, axis=0)) <= dinosaur.MAX_SPEEDS_RAD_PER_S * STEP_S + 1e-12
        ).all()


@pytest.mark.parametrize("motion", dinosaur.MOTIONS, ids=lambda motion: motion.name)
def test_every_motion_asks_only_what_the_joints_can_do(motion):
    times = np.arange(0, motion.period, STEP_S)
    angles = np.array([motion.angles(t, dinosaur.JOINTS) for t in [*times, motion.period]])
    assert (angles >= dinosaur.MIN_ANGLES_RAD - 1e-9).all()
    assert (angles <= dinosaur.MAX_ANGLES_RAD + 1e-9).all()
    assert np.allclose(angles[0], angles[-1])  # a loop closes
    assert (np.abs(np.diff(angles, axis=0)) <= dinosaur.MAX_SPEEDS_RAD_PER_S * STEP_S + 1e-9).all()


def test_the_moods_look_different_and_none_of_them_freezes():
    poses = {}
    for name, emotion in MOODS.items():
        body = body_at()
        body.express(emotion)
        live(body, 0, 4)
        assert body.state().motion == dinosaur.CATALOGUE.motions.index(name)
        angles = live(body, 4, 6)
        assert angles.std(axis=0).max() > np.radians(5)
        poses[name] = angles.mean(axis=0)
    for one, other in (("happy", "neutral"), ("neutral", "angry"), ("happy", "angry")):
        assert np.abs(poses[one] - poses[other]).max() > np.radians(15)


def test_feelings_change_at_a_bounded_rate_and_pass_neutral():
    body = body_at()
    body.express(MOODS["angry"])
    live(body, 0, 3)
    body.express(MOODS["happy"])
    moods, before = [], body.emotion
    for step in range(round(3 / STEP_S)):
        live(body, 3 + step * STEP_S, STEP_S)
        after = body.emotion
        moved = np.hypot(after.valence - before.valence, after.arousal - before.arousal)
        assert moved <= MAX_EMOTION_SPEED * STEP_S + 1e-12
        moods.append(body.state().mood)
        before = after
    words = [dinosaur.CATALOGUE.moods[mood] for mood in moods]
    assert list(dict.fromkeys(words)) == ["angry", "neutral", "happy"]
    assert before == MOODS["happy"]


def test_what_happens_does_not_depend_on_how_often_it_is_looked_at():
    often, seldom = body_at(5), body_at(5)
    for body in (often, seldom):
        body.express(MOODS["happy"])
    for step in range(1, 1001):
        often.advance(step * 0.003)
    for step in range(1, 4):
        seldom.advance(step * 1.0)
    assert np.array_equal(often.angles, seldom.angles)
    assert often.state() == seldom.state()


def test_the_same_seed_gives_the_same_robot_and_another_another():
    assert body_at(1).state() == body_at(1).state()
    assert body_at(1).state().battery != body_at(2).state().battery


def test_the_battery_runs_down_and_is_charged_before_it_is_empty():
    battery = Battery(0.8)
    levels = []
    for _ in range(6 * 60):  # six hours
        for _ in range(round(60 / STEP_S)):
            battery.advance(STEP_S)
        levels.append(battery.level)
    change = np.diff(levels)
    assert min(levels) >= 0.04
    assert max(levels) > 0.95
    assert change.min() < 0 < change.max()


def test_a_body_that_slept_does_not_live_through_the_night_at_once():
    body = body_at()
    body.express(MOODS["happy"])
    body.advance(3600.0 * 8)
    assert body.emotion == Emotion(0, 0)


def test_a_motion_played_once_gives_way_to_the_mood():
    body = body_at()
    body.play(m.ITEM_MOTION, dinosaur.CATALOGUE.motions.index("bow"))
    live(body, 0, 1)
    assert body.state().motion == dinosaur.CATALOGUE.motions.index("bow")
    live(body, 1, 4)
    assert body.state().motion == 0


def test_the_catalogue_fits_the_protocol():
    catalogue = dinosaur.CATALOGUE
    assert len(catalogue.joints) == 14 <= m.JOINTS_MAX
    names = catalogue.motions + catalogue.sounds
    assert len(set(names)) == len(names)  # `play` knows them apart
    assert {loop.sound for loop in dinosaur.MOOD_LOOPS} <= set(catalogue.sounds)


def test_a_moods_own_motion_that_is_played_ends_like_any_other():
    body = DinosaurBody()
    body.advance(0.0)
    body.play(m.ITEM_MOTION, dinosaur.CATALOGUE.motions.index("happy"))
    body.advance(1.0)
    assert body.state().motion == dinosaur.CATALOGUE.motions.index("happy")
    for second in range(2, 7):
        body.advance(float(second))
    assert body.state().motion == dinosaur.CATALOGUE.motions.index("neutral")
