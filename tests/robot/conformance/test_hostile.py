"""Whatever is at the other end, the suite comes to an end and says what it found."""

from dataclasses import replace

import pytest
import serial

from cubeling.robot.conformance import (
    PortChannel,
    SimulatedChannel,
    all_checks,
    exchange,
    received,
    run_checks,
    select_checks,
)
from cubeling.robot.conformance.checks.log import LOG
from cubeling.robot.conformance.checks.moving import MOVING
from cubeling.robot.conformance.probe import Probe
from cubeling.robot.conformance.suite import MAX_DURATION_S
from cubeling.robot.errors import RobotError
from cubeling.robot.protocol import messages as m, timing
from cubeling.robot.protocol.schema import unpack
from cubeling.robot.protocol.wire import decode_frame
from cubeling.robot.simulators.cubeling import body
from cubeling.robot.simulators.cubeling.simulator import Simulator
from tests.examples import some
from tests.robot.conformance.mutants.base import Mutant


def verdicts(report) -> set[str]:
    return {one.verdict for one in report.results}


class Silent(Mutant):
    def on_body(self, number, session, body):
        pass


def test_a_silent_robot_is_given_up_after_two_seconds():
    line = SimulatedChannel(Silent())
    begin = line.now()
    with pytest.raises(
        RobotError, match=r"no robot of this protocol answers.*nothing was received"
    ):
        run_checks(line, all_checks(), 1)
    assert line.now() - begin < timing.ANSWER_WITHIN + 0.5


class Babbler(Silent):
    def on_advance(self):
        self.write(bytes(range(256)))


def test_a_robot_that_sends_only_noise_is_given_up_too():
    with pytest.raises(RobotError, match=r"bytes were received, but no answer"):
        run_checks(SimulatedChannel(Babbler()), all_checks(), 1)


class BabblingRobot(Mutant):
    def on_advance(self):
        if round(self.now * 1000) % 20 == 0:
            self.write(b"\0oh so much to say" * 5)


@pytest.mark.slow(reason="all checks are run")
def test_a_robot_that_sends_noise_between_frames_fails_in_bounded_time():
    line = SimulatedChannel(BabblingRobot())
    begin = line.now()
    report = run_checks(line, all_checks(), 1)
    assert not report.conforms
    assert {one.check.name for one in report.results if one.verdict == "failed"} >= {
        "sends valid frames",
        "silent without session",
    }
    assert line.now() - begin < MAX_DURATION_S + 15


class StatesWithoutEnd(Mutant):
    """Sends a valid STATE every millisecond, in a session or not."""

    def on_advance(self):
        state = m.State(0, 0, 0, 0.0, 0.0, 1.0, 0, m.NOTHING, m.NOTHING, (0.0,) * 16)
        self.send(self.session or 1, state)


def test_a_robot_that_never_stops_sending_states_fills_no_memory(monkeypatch):
    monkeypatch.setattr(received, "MAX_STATES", 50)
    monkeypatch.setattr(exchange, "MAX_QUEUED_FRAMES", 50)
    robot = Probe(SimulatedChannel(StatesWithoutEnd()), 1)
    robot.open_session()
    assert len(robot.receive(0.2)) == len(robot.log.states) == 50


class Hangs(Mutant):
    def set_up(self):
        self.heard = 0

    def on_body(self, number, session, body):
        self.heard += 1
        if self.heard < 300:
            super().on_body(number, session, body)

    def send_message(self, session, message):
        if self.heard < 300:
            super().send_message(session, message)


def test_after_a_hang_of_the_robot_the_other_checks_are_skipped():
    line = SimulatedChannel(Hangs())
    begin = line.now()
    report = run_checks(line, all_checks(), 1)
    assert len(report.results) == len(all_checks())
    assert verdicts(report) == {"ok", "failed", "skipped"}
    assert report.cut_short == "it no longer answers HELLO"
    assert not report.conforms
    assert line.now() - begin < 10


def test_when_time_is_up_the_other_checks_are_skipped_and_the_robot_does_not_conform():
    report = run_checks(SimulatedChannel(Simulator()), all_checks(), 1, max_duration=1.0)
    assert "have taken 1 s" in report.cut_short
    assert not report.conforms


@pytest.mark.full
@pytest.mark.slow(reason="all checks are run")
def test_a_robot_that_takes_five_seconds_for_an_emotion_has_time_enough(monkeypatch):
    monkeypatch.setattr(body, "MAX_EMOTION_SPEED", 0.31)
    report = run_checks(SimulatedChannel(Simulator()), all_checks(), 1)
    assert report.conforms
    assert 40 < report.seconds < MAX_DURATION_S


class Listener(Simulator):
    """Writes down what it is told."""

    def __init__(self) -> None:
        super().__init__()
        self.told: list[object] = []

    def receive(self, data, now):
        for frame in data.split(b"\0"):
            if len(frame) > 4:
                self.told.append(unpack(decode_frame(frame), "host")[1])
        super().receive(data, now)


def test_the_robot_is_always_left_neutral_and_without_a_session():
    robot = Listener()

    def interrupt(result) -> None:
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        run_checks(SimulatedChannel(robot), select_checks(["stop holds"]), 1, interrupt)
    assert isinstance(robot.told[-1], m.Bye)
    assert robot.link.session == 0
    assert robot.body.target.valence == robot.body.target.arousal == 0
    assert not robot.body.state().flags & m.FLAG_STILL


class DeadPort:
    """A port that is pulled out after so many reads, or does not take bytes."""

    def __init__(self, reads: int = 0, full: bool = False) -> None:
        self.reads, self.full = reads, full

    @property
    def in_waiting(self) -> int:
        return 1

    def read(self, size: int = 1, /) -> bytes:
        self.reads -= 1
        if self.reads < 0:
            raise serial.SerialException("device reports readiness to read but returned no data")
        return b"\1"

    def write(self, data: bytes, /) -> int:
        if self.full:
            raise serial.SerialTimeoutException("Write timeout")
        return len(data)

    def close(self) -> None:
        pass


def ticking():
    time = 0.0

    def clock() -> float:
        nonlocal time
        time += 0.01
        return time

    return clock


def test_a_port_that_is_pulled_out_ends_the_suite_in_one_line():
    with pytest.raises(RobotError, match="the port was lost during the checks"):
        run_checks(PortChannel(DeadPort(reads=20), ticking()), all_checks(), 1)


def test_a_robot_that_does_not_read_its_line_is_given_up():
    with pytest.raises(RobotError, match="no robot of this protocol answers"):
        run_checks(PortChannel(DeadPort(reads=10**6, full=True), ticking()), all_checks(), 1)


class HasAJointOfSpeedZero(Mutant):
    def send_message(self, session, message):
        if isinstance(message, m.Joint) and message.index == 3:
            message = replace(message, speed=0.0)
        super().send_message(session, message)


@pytest.mark.full
@pytest.mark.slow(reason="all checks are run")
def test_a_joint_of_speed_zero_is_a_failed_check():
    report = run_checks(SimulatedChannel(HasAJointOfSpeedZero()), all_checks(), 1)
    failed = {one.check.name: one.received for one in report.results if one.verdict == "failed"}
    assert set(failed) == {"joint limits sensible", "joints within speed"}
    assert "speed=0.0" in failed["joint limits sensible"]


class Version2(Mutant):
    version = 2

    def on_body(self, number, session, body):
        if number == 0x13:
            return
        if number == 0x01 and len(body) > 3:
            body = body[:3] + bytes([min(body[3], self.version)]) + body[4:]
        super().on_body(number, session, body)


class Version1(Version2):
    version = 1

    def on_body(self, number, session, body):
        super().on_body(number, session, body[:11] if number == 0x10 else body)


NEW_IN_VERSION_2 = {
    "express of version 2 used",
    "version of the last hello",
    "unknown mood refused",
    "named mood shown at once",
    "mood 255 leaves the choice",
    "stop ends a named mood",
    "refused express ends nothing",
    "short express leaves the choice",
}
NEW_IN_VERSION_3 = {
    "result in state",
    "refusal in earlier versions",
    *(check.name for check in [*MOVING, *LOG]),
}


@pytest.mark.slow(reason="all checks are run")
@pytest.mark.parametrize(
    ("robot", "skipped"),
    some([(Version1, NEW_IN_VERSION_2 | NEW_IN_VERSION_3), (Version2, NEW_IN_VERSION_3)]),
)
def test_a_robot_of_an_earlier_version_conforms(robot, skipped):
    report = run_checks(SimulatedChannel(robot()), all_checks(), 1)
    assert report.conforms
    assert report.welcome.version == robot.version
    assert {one.check.name for one in report.results if one.verdict == "skipped"} == skipped


@pytest.mark.slow(reason="all checks are run")
def test_our_simulated_robot_conforms():
    report = run_checks(SimulatedChannel(Simulator(7)), all_checks(), 2**32 - 1)
    assert verdicts(report) == {"ok"}
