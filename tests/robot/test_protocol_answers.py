"""What PROTOCOL.md answers to doubts, of our simulator, our firmware and our driver."""

from typing import Any

import pytest

from cubeling.affect import Emotion
from cubeling.robot.conformance import SimulatedChannel
from cubeling.robot.conformance.probe import Probe
from cubeling.robot.drivers.cubeling.host import HostLink
from cubeling.robot.protocol import messages as m
from cubeling.robot.protocol.schema import pack, unpack
from cubeling.robot.protocol.wire import FrameReader, encode_frame
from cubeling.robot.simulators.cubeling.simulator import Simulator
from tests.robot.firmware.conftest import Dino


@pytest.fixture(params=[Simulator, Dino], ids=["simulator", "firmware"])
def probe(request) -> Probe:
    return Probe(SimulatedChannel(request.param()), 77)


def test_a_message_in_session_0_is_answered_by_gone(probe):
    for session_open in (False, True):
        if session_open:
            probe.open_session()
        probe.send(m.Beat(7), session=0)
        probe.expect(m.Gone, "BEAT in session 0", session=0)
        probe.receive(0.03)


def test_the_length_of_express_decides_in_a_session_of_version_1(probe):
    probe.open_session(offer=1)
    for size, mood in ((12, 2), (11, 0)):
        number = probe.next_number()
        body = pack(m.Express(number, 0.0, 0.0, 2), probe.session, 2)[:size]
        probe.write(encode_frame(body))
        probe.expect(m.Ack, "EXPRESS", number=number)
        assert probe.keep_alive(0.25)[-1].mood == mood


def test_after_255_the_first_mood_comes_when_the_emotion_is_near_neutral(probe):
    probe.open_session()
    probe.express(0.9, 0.6)
    probe.expect_state(lambda state: state.valence > 0.85, 5, "happy", "valence")
    probe.send(m.Bye())
    probe.reopen_session()
    moods = [state.mood for state in probe.keep_alive(3)]
    assert moods[0] == 1
    assert moods[-1] == 0


def test_the_same_motion_again_begins_again(probe: Probe) -> None:
    probe.open_session()
    index = 3

    def play() -> float:
        probe.command(m.Play(probe.next_number(), m.ITEM_MOTION, index))
        return probe.now

    begin = play()
    probe.expect_state(lambda state: state.motion != index and probe.now > begin + 0.3, 9, "end")
    length = probe.now - begin
    begin = play()
    probe.keep_alive(length / 2)
    play()
    probe.expect_state(lambda state: state.motion != index and probe.now > begin + length, 9, "end")
    assert probe.now - begin == pytest.approx(1.5 * length, abs=0.2)


LEVEL = (0.0,) * m.JOINTS_MAX


def test_a_move_has_the_same_effect_in_a_session_of_an_earlier_version(probe):
    probe.open_session(offer=2)
    probe.command(m.Move(probe.next_number(), 0.1, 0, 0b10, LEVEL))
    probe.reopen_session()
    assert probe.beat().held == 0b10


def test_a_move_of_nothing_ends_a_stop_and_the_joints_follow_the_neutral_mood(probe):
    probe.open_session()
    probe.command(m.Stop(probe.next_number()))
    assert probe.keep_alive(0.3)[-1].flags & m.FLAG_STILL
    probe.command(m.Move(probe.next_number(), 0.0, 0, 0, LEVEL))
    state = probe.keep_alive(1.5)[-1]
    assert (state.flags & m.FLAG_STILL, state.held, state.motion) == (0, 0, 0)
    assert any(state.joints)


def test_a_second_move_begins_where_the_joint_is_on_its_way(probe):
    probe.open_session()
    joint = 1
    angles = (*LEVEL[:joint], 0.5, *LEVEL[joint + 1 :])
    probe.command(m.Move(probe.next_number(), 1.5, 0, 1 << joint, angles))
    way = [state.joints[joint] for state in probe.keep_alive(0.75)]
    probe.command(m.Move(probe.next_number(), 1.5, 0, 1 << joint, LEVEL))
    back = [state.joints[joint] for state in probe.keep_alive(0.3)]
    assert back[0] == pytest.approx(way[-1], abs=0.05)
    assert 0.1 < back[-1] < way[-1]


def test_stop_is_never_refused_and_the_result_is_then_that_of_stop(probe):
    probe.open_session()
    probe.command(m.Play(probe.next_number(), m.ITEM_MOTION, 99), m.RESULT_REFUSED)
    probe.command(m.Stop(probe.next_number()))
    assert probe.beat().result == m.RESULT_TAKEN


@pytest.mark.parametrize("make", [Simulator, Dino], ids=["simulator", "firmware"])
def test_after_49_days_the_clock_begins_at_0(make):
    robot = make()
    robot.advance(0.0)
    start = (2**32 - 60) / 1000
    robot.receive(encode_frame(pack(m.Hello(3, 5), 1)), start)
    robot.bytes_to_send()
    times = []
    for ms in range(0, 120, 30):
        robot.receive(encode_frame(pack(m.Beat(ms), 1)), start + ms / 1000)
        received = [unpack(one, "robot")[1] for one in FrameReader().feed(robot.bytes_to_send())]
        times += [one.time for one in received if isinstance(one, m.State) and one.beat == ms]
    assert times == [2**32 - 60, 2**32 - 30, 0, 30]


def sent(host: HostLink) -> list[Any]:
    return [unpack(body, "host")[1] for body in FrameReader().feed(host.bytes_to_send())]


def answer(host: HostLink, message: object, now: float, damage: bytes = b"") -> None:
    body = pack(message, 1, 2)
    host.receive(encode_frame(body[: len(body) - len(damage)] + damage), now)


def test_the_count_of_beat_begins_at_1_and_65535_is_followed_by_0():
    round_trip = HostLink(7).round_trip
    counts = [round_trip.start(0.0) for _ in range(65537)]
    assert counts[0] == 1
    assert counts[-3:] == [65535, 0, 1]


def test_a_name_that_is_not_utf_8_is_skipped():
    host = HostLink(7)
    host.port_opened(0.0)
    welcome = m.Welcome(2, 0, 5, 0, 0, 0, 0, "Dino", "x" * 16)
    answer(host, welcome, 0.01, b"\xc3")
    assert host.telemetry(0.01).counts.skipped == 1
    assert host.catalogue is None
    answer(host, welcome, 0.02)
    assert host.catalogue is not None


def test_an_ack_that_answers_nothing_in_flight_is_ignored():
    host = HostLink(7)
    host.port_opened(0.0)
    answer(host, m.Welcome(2, 0, 5, 0, 0, 0, 0, "Dino", "x"), 0.01)
    answer(host, m.Ack(1, m.RESULT_TAKEN), 0.02)
    sent(host)
    host.express(Emotion(0.5, 0.5))
    host.tick(0.03)
    assert [one.number for one in sent(host) if isinstance(one, m.Express)] == [1]
    answer(host, m.Ack(9, m.RESULT_TAKEN), 0.04)
    assert host.telemetry(0.04).acknowledged is None
    answer(host, m.Ack(1, m.RESULT_TAKEN), 0.05)
    assert host.telemetry(0.05).acknowledged == Emotion(0.5, 0.5)
