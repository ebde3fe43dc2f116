"""What version 3 added, between our host and our simulated robot: reasons, log, time, joints."""

import math
from itertools import pairwise

import pytest

from cubeling.affect import Emotion
from cubeling.robot.contract.moves import joint_move
from cubeling.robot.contract.telemetry import MAX_LOG_LINES
from cubeling.robot.protocol import messages as m, timing
from cubeling.robot.protocol.schema import pack
from cubeling.robot.protocol.wire import encode_frame
from cubeling.robot.simulators.cubeling.dinosaur import CATALOGUE
from cubeling.robot.simulators.cubeling.simulator import Simulator
from tests.examples import some

TORSO = [joint.name for joint in CATALOGUE.joints].index("torso")


@pytest.fixture
def open_world(world):
    opened = world()
    opened.run_until(lambda: opened.telemetry.state == "ready", within=0.5)
    return opened


def move(w, duration=0.5, **angles):
    named = {name.replace("_", " "): angle for name, angle in angles.items()}
    assert w.host.joint_mover.move(joint_move(w.host.catalogue, named, duration))


# --- Joints --------------------------------------------------------------------------------------


def test_a_joint_goes_evenly_to_its_angle_and_is_held_whatever_is_felt_or_played(open_world):
    w = open_world
    w.run(0.5)
    before = w.telemetry.joints["neck up"]
    move(w, 1.0, neck_up=-0.3)
    w.run(0.5)
    assert w.telemetry.joints["neck up"] == pytest.approx((before - 0.3) / 2, abs=0.05)
    w.run(0.7)
    w.host.express(Emotion(0.8, 0.5, "happy"))
    w.host.play(m.ITEM_MOTION, CATALOGUE.motions.index("nod"))
    for _ in range(20):
        w.run(0.1)
        assert w.telemetry.joints["neck up"] == pytest.approx(-0.3, abs=0.02)
    assert w.telemetry.held == {"neck up"}
    assert w.telemetry.label == "happy"
    move(w, neck_up=None)
    w.run(1.0)
    assert w.telemetry.held == frozenset()
    assert w.telemetry.joints["neck up"] > 0.2


def test_no_joint_is_faster_than_it_can_be(open_world):
    w = open_world
    move(w, 0.0, torso=0.2)
    angles = []
    w.run(0.4, lambda: angles.append(w.robot.body.angles[TORSO]))
    steps = [abs(after - before) for before, after in pairwise(angles)]
    assert max(steps) <= CATALOGUE.joints[TORSO].speed * 0.020 + 1e-9
    assert max(angles) < 0.15


@pytest.mark.parametrize("end", ["stop", "failsafe", "close"])
def test_whatever_ends_the_hosts_rule_lets_go_of_all_joints(open_world, end):
    w = open_world
    move(w, torso=0.2, tail_up=0.5)
    w.run(0.2)
    assert w.robot.body.state().held.bit_count() == 2
    if end == "stop":
        w.host.stop()
    elif end == "close":
        w.host.close()
    else:
        w.to_robot.cut = True
    w.run(timing.FAILSAFE_PROMISE)
    assert w.robot.body.state().held == 0


def test_a_move_is_not_restored_after_the_failsafe_but_outlives_a_short_break(open_world):
    w = open_world
    w.host.express(Emotion(0.5, 0.5))
    move(w, torso=0.2)
    w.run(0.2)
    w.host.port_lost()
    w.run(0.1)
    w.host.port_opened(w.now)
    w.run(0.2)
    assert w.telemetry.held == {"torso"}
    w.to_robot.cut = True
    w.run(1.0)
    w.to_robot.cut = False
    w.run(0.5)
    assert w.telemetry.held == frozenset()
    assert w.telemetry.acknowledged == Emotion(0.5, 0.5)


def test_of_moves_that_wait_the_latest_counts_for_each_joint(open_world):
    w = open_world
    scheduler = w.host.scheduler
    for angle in (0.01, 0.02, 0.03):
        move(w, torso=angle)
        move(w, tail_up=angle)
    assert [one.moved.bit_count() for one in scheduler.actions] == [1, 1]
    move(w, tail_up=0.2, torso=0.04)
    move(w, tail_up=0.3)
    assert [one.moved.bit_count() for one in scheduler.actions] == [2, 1]
    w.run(0.5)
    assert w.telemetry.counts.dropped == 0
    assert w.telemetry.held == {"torso", "tail up"}


def test_moves_survive_a_bad_line_in_order_and_once(world):
    w = world(seed=5, drop=0.1, flip=0.005, dup=0.1)
    w.run_until(lambda: w.telemetry.state == "ready", within=5)
    told = []
    moved = w.robot.body.move

    def seen(command):
        told.append(command.angles[TORSO])
        moved(command)

    w.robot.body.move = seen
    for index in range(1, 60):
        move(w, torso=index / 1000)
        w.run(0.1)
    w.run_until(lambda: told[-1:] == [0.059], within=3)
    assert told == sorted(set(told))


# --- Refusals ------------------------------------------------------------------------------------


def exhausted(w):
    """Empty the robot's battery."""
    w.robot.body._battery.level = 0.05


@pytest.mark.parametrize("lost", [False, True], ids=["told by ACK", "told by STATE alone"])
def test_the_reason_of_a_refusal_reaches_the_user_in_words(open_world, lost):
    w = open_world
    exhausted(w)
    if lost:
        process = w.robot.link.obey
        w.robot.link.obey = lambda command: (process(command), w.robot.link.bytes_to_send())[0]
    w.host.play(m.ITEM_MOTION, CATALOGUE.motions.index("nod"))
    w.run(0.2)
    assert w.telemetry.complaint == "nod: refused, its battery is low"
    assert w.telemetry.counts.refused == 1
    move(w, torso=0.1)
    w.run(0.2)
    assert w.telemetry.complaint == "torso: refused, its battery is low"
    assert w.telemetry.held == frozenset()
    w.host.express(Emotion(0.1, 0.1))
    w.run(0.2)
    assert w.telemetry.complaint is None


def test_a_reason_that_the_host_does_not_know_is_a_refusal_too(open_world):
    w = open_world
    w.robot.body.refusal = lambda: 99
    w.host.play(m.ITEM_MOTION, 3)
    w.run(0.2)
    assert w.telemetry.complaint == "nod: refused, for a reason of its own, 99"


# --- The log -------------------------------------------------------------------------------------


def test_a_line_of_the_log_arrives_with_the_time_at_which_it_was_written(open_world):
    w = open_world
    w.run(2.0)
    (started,) = w.telemetry.log
    assert (started.severity, started.text) == ("information", "started")
    written = w.now
    w.host.play(m.ITEM_MOTION, 200)
    w.run(0.3)
    line = w.telemetry.log[-1]
    assert (line.number, line.severity, line.lost) == (2, "warning", 0)
    assert line.text.endswith("no motion 200")
    assert line.timestamp == pytest.approx(written, abs=0.02)


def test_a_flood_of_lines_is_bounded_at_both_ends_and_those_missing_are_counted(open_world):
    w = open_world
    for _ in range(60):
        w.robot.link.log.write(m.SEVERITY_ERROR, "ä" * 60, 0)
    w.run(0.3)
    assert len(w.telemetry.log) <= 5
    w.run(3.0)
    w.robot.link.log.write(m.SEVERITY_ERROR, "the last", 0)
    w.run(0.2)
    *_, before, last = w.telemetry.log
    assert before.text == "ä" * 40
    assert (last.text, last.lost) == ("the last", 60 - 8)
    for _ in range(50):
        w.robot.link.log.write(m.SEVERITY_INFO, "one more", 0)
        w.run(0.11)
    assert len(w.telemetry.log) == MAX_LOG_LINES
    assert w.telemetry.state == "ready"


def test_a_line_that_the_serial_line_doubles_is_one_line(open_world):
    w = open_world
    w.run(0.2)
    for count in (9, 9, 10):
        log = m.Log(count, 0, 77, "x")
        w.host.receive(encode_frame(pack(log, w.robot.link.session)), w.now)
    assert [line.severity for line in w.telemetry.log] == ["information", "error", "error"]


def test_lines_from_before_a_session_wait_for_it(world):
    w = world()
    w.to_robot.cut = True
    booted = w.now + w.step
    for text, time in (("first", 200), ("second", 700)):
        w.robot.link.log.write(m.SEVERITY_ERROR, text, time)
    w.run(1.0)
    w.to_robot.cut = False
    w.run(1.5)
    assert [line.text for line in w.telemetry.log] == ["started", "first", "second"]
    times = [line.timestamp - booted for line in w.telemetry.log]
    assert times == pytest.approx([0.0, 0.2, 0.7], abs=0.01)


# --- Time ----------------------------------------------------------------------------------------


class Drifting(Simulator):
    """A robot whose clock is fast or slow, and that remembers when it made its STATEs."""

    def __init__(self, drift: float) -> None:
        super().__init__()
        self.drift = drift
        self.made: list[float] = []
        state = self.body.state

        def seen() -> m.State:
            self.made.append(self.true)
            return state()

        self.body.state = seen  # type: ignore[method-assign] # a spy on this one body

    def receive(self, data: bytes, now: float) -> None:
        self.true = now
        super().receive(data, now * (1 + self.drift))


@pytest.mark.parametrize("drift", some([200e-6, -200e-6]))
def test_telemetry_is_in_session_time_over_a_line_with_jitter(world, drift):
    """A line that delays by 2 to 22 ms each way: within 8 ms, and always within the bound."""
    w = world(seed=3, delay=0.012, jitter=0.010, step=0.001)
    w.robot = Drifting(drift)
    w.run(3.0)
    errors = []
    for _ in range(300):
        w.run(0.1)
        telemetry = w.telemetry
        error = min(abs(telemetry.measured_at - made) for made in w.robot.made[-20:])
        assert error <= telemetry.clock.error
        assert telemetry.measured_at <= w.now
        errors.append(error)
    assert max(errors) < 0.008
    assert telemetry.clock.drift == pytest.approx(drift, abs=60e-6)
    assert math.isclose(telemetry.clock.error, 0.005, abs_tol=0.005)


def test_after_a_reboot_the_clock_is_read_anew(open_world):
    w = open_world
    w.run(20.0)
    w.reboot()
    w.run(1.0)
    assert w.telemetry.counts.sessions == 2
    assert w.telemetry.measured_at == pytest.approx(w.now, abs=0.06)
