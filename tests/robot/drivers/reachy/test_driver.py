"""Reachy Mini's driver without a robot: what it asks for, how often, and how far it trusts."""

import json
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

from cubeling.affect import Emotion
from cubeling.robot.drivers.reachy import motions
from cubeling.robot.drivers.reachy.driver import (
    LOST_AFTER_S,
    MAX_LINE_BYTES,
    TARGET_INTERVAL_S,
    TARGET_TIMEOUT_S,
    ReachyDriver,
)
from cubeling.robot.protocol import messages as m
from tests.examples import examples

HAPPY = Emotion(0.8, 0.6, "happy")
MOODS = tuple(motion.name for motion in motions.MOODS)


class Desk:
    """A driver in virtual time, and a robot that takes what it is asked unless it is deaf."""

    def __init__(self) -> None:
        self.now = 10.0
        self.driver = ReachyDriver()
        self.asked: list[tuple[float, list[float]]] = []
        self.deaf = False
        self.driver.port_opened(self.now)
        self.tell(hello="daemon 1.12.0", joints=[0.0] * 6, limp=False)

    def tell(self, **what: object) -> None:
        self.driver.receive(json.dumps(what).encode() + b"\n", self.now)

    def run(self, seconds: float) -> None:
        for _ in range(round(seconds / 0.01)):
            self.now += 0.01
            self.driver.tick(self.now)
            for line in self.driver.bytes_to_send().splitlines():
                said = json.loads(line)
                self.asked.append((self.now, said["target"]))
                if not self.deaf:
                    self.tell(taken=said["number"], joints=said["target"], limp=False)


def test_targets_are_sent_at_most_at_their_rate():
    desk = Desk()
    for index in range(500):
        desk.driver.express(Emotion(index / 1000, 0.5, "happy"))
        desk.run(0.01)
    times = np.array([when for when, _ in desk.asked])
    assert len(times) > 80
    assert np.diff(times).min() >= TARGET_INTERVAL_S - 1e-6


@settings(max_examples=examples(25))
@given(st.lists(st.tuples(st.sampled_from(MOODS), st.floats(0.05, 2.0)), min_size=1, max_size=6))
def test_no_joint_leaves_its_limits_or_is_faster_than_allowed(moods):
    desk = Desk()
    for word, seconds in moods:
        desk.driver.express(replace(HAPPY, word=word))
        desk.driver.play(m.ITEM_MOTION, len(desk.asked) % len(motions.MOTIONS))
        desk.run(seconds)
    times = np.array([when for when, _ in desk.asked])
    angles = np.array([target for _, target in desk.asked])
    assert (angles >= motions.MIN_ANGLES_RAD - 1e-4).all()
    assert (angles <= motions.MAX_ANGLES_RAD + 1e-4).all()
    speeds = np.abs(np.diff(angles, axis=0)) / np.diff(times)[:, None]
    assert (speeds <= motions.MAX_SPEEDS_RAD_PER_S * 1.01 + 1e-3).all()
    assert np.abs(angles[:, 2] - angles[:, 3]).max() <= np.radians(65)


def test_every_mood_moves_and_neutral_is_where_a_stopped_robot_stands():
    seen = {}
    for word in MOODS:
        desk = Desk()
        desk.driver.express(replace(HAPPY, word=word))
        desk.run(6.0)
        seen[word] = np.array([target for _, target in desk.asked])
        desk.driver.stop()
        desk.run(3.0)
        assert np.abs(desk.asked[-1][1]).max() < 1e-3
        assert desk.driver.telemetry(desk.now).stopped
    means = [angles[-100:].mean(axis=0) for angles in seen.values()]
    for index, one in enumerate(means):
        assert all(np.abs(one - other).max() > 0.05 for other in means[:index])


def test_what_is_acknowledged_is_what_the_robot_took():
    desk = Desk()
    desk.deaf = True
    desk.driver.express(HAPPY)
    desk.run(1.0)
    assert desk.driver.telemetry(desk.now).acknowledged is None
    assert len(desk.asked) <= 1.0 / TARGET_TIMEOUT_S + 1  # one on its way at a time
    desk.deaf = False
    desk.run(1.0)
    known = desk.driver.telemetry(desk.now)
    assert known.acknowledged == HAPPY
    assert known.observed is None


def test_what_is_acknowledged_stays_until_the_next_is_taken_or_the_robot_is_lost():
    desk = Desk()
    desk.driver.express(HAPPY)
    desk.run(1.0)
    desk.deaf = True
    desk.driver.express(Emotion(-0.6, -0.4, "sad"))
    desk.run(0.2)
    assert desk.driver.telemetry(desk.now).acknowledged == HAPPY
    desk.run(LOST_AFTER_S)
    known = desk.driver.telemetry(desk.now)
    assert (known.state, known.acknowledged) == ("lost", None)


def test_a_robot_is_not_called_stopped_before_it_stands_still():
    desk = Desk()
    desk.driver.express(HAPPY)
    desk.run(1.0)
    desk.driver.stop()
    assert not desk.driver.telemetry(desk.now).stopped
    desk.run(3.0)
    known = desk.driver.telemetry(desk.now)
    assert (known.stopped, known.acknowledged) == (True, None)
    desk.driver.express(HAPPY)
    desk.run(0.3)
    assert not desk.driver.telemetry(desk.now).stopped


def test_a_motion_is_played_once_and_the_mood_goes_on():
    desk = Desk()
    desk.driver.express(replace(HAPPY, word="sad"))
    desk.run(2.0)
    assert desk.driver.play(m.ITEM_MOTION, [one.name for one in motions.MOTIONS].index("nod"))
    desk.run(0.5)
    assert desk.driver.telemetry(desk.now).motion == "nod"
    desk.run(3.0)
    assert desk.driver.telemetry(desk.now).motion == "sad"


def test_a_robot_whose_motors_are_off_is_limp():
    desk = Desk()
    desk.tell(joints=[0.0] * 6, limp=True)
    assert desk.driver.telemetry(desk.now).limp


def test_silence_is_degraded_then_lost_and_a_new_hello_brings_it_back():
    desk = Desk()
    desk.deaf = True
    states = []
    for _ in range(round((LOST_AFTER_S + 0.2) / 0.1)):
        desk.run(0.1)
        states.append(desk.driver.state(desk.now))
    assert [states[0], states[10], states[-1]] == ["ready", "degraded", "lost"]
    desk.driver.port_lost()
    desk.driver.port_opened(desk.now)
    assert desk.driver.state(desk.now) == "lost"
    desk.deaf = False
    desk.driver.express(HAPPY)
    desk.tell(hello="daemon 1.12.0", joints=[0.3] * 6)
    desk.run(1.0)
    assert desk.driver.state(desk.now) == "ready"
    assert desk.driver.telemetry(desk.now).acknowledged == HAPPY
    assert desk.driver.telemetry(desk.now).counts.sessions == 2


@given(st.lists(st.binary(max_size=300), max_size=20))
def test_garbage_raises_nothing_and_is_not_kept(chunks):
    desk = Desk()
    for chunk in chunks:
        desk.driver.receive(chunk, desk.now)
        desk.driver.receive(b"x" * 5000, desk.now)
    assert len(desk.driver.reader.partial) <= MAX_LINE_BYTES
    assert desk.driver.telemetry(desk.now).counts.crc_errors >= min(1, len(chunks))
    desk.driver.receive(b"\n", desk.now)
    desk.run(0.2)
    assert desk.driver.telemetry(desk.now).state == "ready"


@pytest.mark.parametrize(
    "line",
    [b"[1]", b'{"joints": "no"}', b'{"joints": [null, NaN, 1e99, true]}', b'{"taken": {}}',
     b'{"hello": {"a": 1}}', b"[" * 3000],
)  # fmt: skip
def test_any_line_is_survived(line):
    desk = Desk()
    desk.driver.receive(line + b"\n", desk.now)
    desk.run(0.5)
    angles = np.array([target for _, target in desk.asked])
    assert np.isfinite(angles).all()
