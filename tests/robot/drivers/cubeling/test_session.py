"""Host and robot over a good line: sessions, commands, silence, failsafe."""

from typing import Any

import pytest

from cubeling.affect import Emotion
from cubeling.robot.protocol import messages as m, timing
from cubeling.robot.protocol.schema import pack, unpack
from cubeling.robot.protocol.wire import FrameReader, encode_frame
from cubeling.robot.simulators.cubeling.dinosaur import CATALOGUE
from cubeling.robot.simulators.cubeling.simulator import Simulator

HAPPY = Emotion(0.8, 0.5)
ANGRY = Emotion(-0.9, 0.6)


@pytest.fixture
def open_world(world):
    opened = world()
    opened.run_until(lambda: opened.telemetry.state == "ready", within=0.5)
    return opened


def test_a_robot_reports_its_whole_catalogue(open_world):
    told = open_world.host.catalogue
    assert told.name == "Dino"
    assert (told.motions, told.sounds, told.moods) == (
        CATALOGUE.motions, CATALOGUE.sounds, CATALOGUE.moods,
    )  # fmt: skip
    for joint, true in zip(told.joints, CATALOGUE.joints, strict=True):
        assert joint.name == true.name
        assert joint.low == pytest.approx(true.low, abs=5e-4)
        assert joint.high == pytest.approx(true.high, abs=5e-4)
        assert joint.speed == pytest.approx(true.speed, abs=5e-4)


@pytest.mark.parametrize("step", [0.001, 0.007, 0.020])
def test_a_beat_is_sent_every_50_ms_in_the_mean_however_rarely_the_host_runs(world, step):
    w = world(step=step)
    w.run_until(lambda: w.telemetry.state == "ready", within=1)
    first = w.host.round_trip.start(w.now)
    w.run(10)
    assert w.host.round_trip.start(w.now) - first == pytest.approx(200, abs=2)


def test_a_hang_of_the_host_is_not_followed_by_a_burst_of_beats(open_world):
    w = open_world
    w.now += 0.3
    first = w.host.round_trip.start(w.now)
    w.run(0.1)
    assert w.host.round_trip.start(w.now) - first <= 4


def test_commanded_acknowledged_and_observed_are_three_things(open_world):
    w = open_world
    w.host.express(HAPPY)
    before = w.telemetry
    assert (before.commanded, before.acknowledged) == (HAPPY, None)
    w.run_until(lambda: w.telemetry.acknowledged == HAPPY, within=0.05)
    assert w.telemetry.observed.valence < 0.1
    lag = w.run_until(lambda: w.telemetry.observed == Emotion(0.8, 0.5, "happy"), within=2)
    assert lag > 0.8  # the robot feels at its own bounded rate
    assert w.telemetry.label == "happy"


def test_only_the_latest_of_many_emotions_is_sent(open_world):
    w = open_world
    levels = iter(range(1000))

    def express_ten_times() -> None:
        for _ in range(10):
            w.host.express(Emotion(next(levels) / 1000, 0))

    w.run(0.5, express_ten_times)
    w.run(0.1)
    assert len(w.applied) <= 101
    assert w.applied[-1][1] == Emotion(0.999, 0)


def test_the_same_emotion_is_sent_once(open_world):
    w = open_world
    w.run(0.5, lambda: w.host.express(HAPPY))
    assert [emotion for _, emotion in w.applied] == [HAPPY]


def test_motions_and_sounds_are_played_once_and_in_order(open_world):
    w = open_world
    played = []
    w.robot.body.play = lambda item, index: played.append((item, index))
    for index in (3, 4, 5):
        assert w.host.play(m.ITEM_MOTION, index)
    assert w.host.play(m.ITEM_SOUND, 1)
    w.run(0.5)
    assert played == [(1, 3), (1, 4), (1, 5), (2, 1)]


def test_a_played_motion_and_sound_are_seen_and_end(open_world):
    w = open_world
    w.host.play(m.ITEM_MOTION, CATALOGUE.motions.index("nod"))
    w.host.play(m.ITEM_SOUND, CATALOGUE.sounds.index("chirp"))
    w.run(0.2)
    assert (w.telemetry.motion, w.telemetry.sound) == ("nod", "chirp")
    w.run(2.5)
    assert (w.telemetry.motion, w.telemetry.sound) == ("neutral", None)


def test_too_many_actions_are_refused(open_world):
    accepted = [open_world.host.play(m.ITEM_MOTION, 3) for _ in range(timing.ACTIONS_MAX + 3)]
    assert accepted.count(True) == timing.ACTIONS_MAX


def test_stop_overtakes_what_waits_and_holds_the_neutral_pose(open_world):
    w = open_world
    w.host.express(HAPPY)
    w.run(2)
    for _ in range(5):
        w.host.play(m.ITEM_MOTION, 4)
    w.host.stop()
    w.run(4)
    assert w.telemetry.stopped
    assert (w.telemetry.motion, w.telemetry.commanded) == (None, None)
    assert abs(w.robot.body.angles).max() < 1e-9
    assert w.telemetry.counts.dropped == 5
    w.host.express(HAPPY)
    w.run(0.2)
    assert not w.telemetry.stopped


def test_an_action_is_dropped_while_the_robot_is_lost(open_world):
    w = open_world
    w.to_robot.cut = w.from_robot.cut = True
    w.run(1)
    assert w.host.play(m.ITEM_MOTION, 3)
    w.to_robot.cut = w.from_robot.cut = False
    w.run(0.5)
    assert w.telemetry.motion == "neutral"
    assert w.telemetry.counts.dropped == 1


def test_an_index_that_the_robot_does_not_have_is_refused_and_counted(open_world):
    w = open_world
    w.host.play(m.ITEM_MOTION, 200)
    w.run(0.2)
    assert w.telemetry.counts.refused == 1
    assert w.telemetry.motion == "neutral"


def test_a_robot_is_neutral_within_half_a_second_of_silence(open_world):
    w = open_world
    w.host.express(HAPPY)
    w.run(2)
    w.to_robot.cut = True
    silent_since = w.now
    w.run_until(lambda: bool(w.neutral_at), within=1)
    assert w.neutral_at[0] - silent_since <= timing.FAILSAFE_PROMISE
    w.run(2)
    assert w.robot.body.emotion == Emotion(0, 0)


def test_a_robot_that_advances_only_every_50_ms_is_neutral_in_time(world):
    w = world(step=0.050)
    w.run_until(lambda: w.telemetry.state == "ready", within=5)
    w.host.express(HAPPY)
    w.run(1)
    w.to_robot.cut = True
    silent_since = w.now
    w.run(1)
    assert w.neutral_at[-1] - silent_since <= timing.FAILSAFE_PROMISE + 1e-9


def test_the_link_reports_its_state_and_recovers_with_the_last_emotion(open_world):
    w = open_world
    w.host.express(HAPPY)
    w.run(1)
    w.to_robot.cut = w.from_robot.cut = True
    silence = timing.DEGRADED_AFTER + timing.BEAT_EVERY
    assert w.run_until(lambda: w.telemetry.state == "degraded", 1) <= silence + 2 * w.step
    w.run_until(lambda: w.telemetry.state == "lost", 1)
    assert w.telemetry.silence == pytest.approx(timing.LOST_AFTER, abs=2 * w.step)
    assert w.telemetry.acknowledged is None
    w.host.express(ANGRY)
    w.run(3)
    w.to_robot.cut = w.from_robot.cut = False
    w.run_until(lambda: w.telemetry.state == "ready", within=0.2)
    w.run_until(lambda: w.telemetry.acknowledged == ANGRY, within=0.2)
    assert w.telemetry.counts.sessions == 2
    assert [emotion for _, emotion in w.applied] == [HAPPY, ANGRY]


def test_an_emotion_that_the_failsafe_ended_is_sent_again(open_world):
    w = open_world
    w.host.express(HAPPY)
    w.run(1)
    w.to_robot.cut = True
    w.run(1)
    w.to_robot.cut = False
    w.run(0.5)
    assert [emotion for _, emotion in w.applied] == [HAPPY, HAPPY]
    assert w.robot.body.target == HAPPY


def test_a_later_action_does_not_acknowledge_a_lost_emotion(open_world):
    # EXPRESS 1 is lost with its session; PLAY 2 is taken first in the next one, which ends too.
    w = open_world
    w.to_robot.cut = True
    w.host.express(HAPPY)
    w.run(0.1)
    w.host.port_lost()
    w.to_robot.cut = False
    w.host.port_opened(w.now)
    w.run(w.step)
    w.host.play(m.ITEM_MOTION, 3)
    w.run_until(lambda: w.telemetry.motion == "nod" or w.robot.link.last_command == 2, within=0.3)
    w.host.port_lost()
    w.host.port_opened(w.now)
    w.run(0.5)
    assert w.robot.body.target == HAPPY


def test_a_state_replaces_a_lost_acknowledgement(open_world):
    w = open_world
    w.run(0.03)
    w.host.express(HAPPY)
    w.host.tick(w.now)
    w.robot.receive(w.host.bytes_to_send(), w.now)
    w.robot.bytes_to_send()  # the ACK, lost
    w.robot.receive(encode_frame(pack(m.Beat(1), w.robot.link.session)), w.now)
    w.host.receive(w.robot.bytes_to_send(), w.now)
    assert w.telemetry.acknowledged == HAPPY
    assert w.telemetry.counts.retries == 0


def test_a_retry_has_the_latest_emotion(open_world):
    w = open_world
    w.to_robot.cut = True
    w.host.express(HAPPY)
    w.run(0.01)
    w.host.express(ANGRY)
    w.to_robot.cut = False
    w.run(0.3)
    assert [emotion for _, emotion in w.applied] == [ANGRY]


def test_a_reboot_is_noticed_at_once_and_the_emotion_restated(open_world):
    w = open_world
    w.host.express(HAPPY)
    w.run(1)
    w.reboot()
    w.run_until(lambda: len(w.applied) == 2, within=0.15)
    assert w.robot.body.target == HAPPY


def test_a_stop_is_restated_after_a_reboot(open_world):
    w = open_world
    w.host.stop()
    w.run(0.2)
    w.reboot()
    w.run(0.5)
    assert w.telemetry.stopped


def test_a_port_that_comes_back_before_the_failsafe_does_not_repeat_the_emotion(open_world):
    w = open_world
    w.host.express(HAPPY)
    w.run(0.3)
    w.host.port_lost()
    w.run(0.2)
    w.host.port_opened(w.now)
    w.run(0.5)
    assert w.telemetry.acknowledged == HAPPY
    assert len(w.applied) == 1
    assert w.telemetry.counts.sessions == 2


def test_a_robot_that_is_not_heard_keeps_its_emotion(open_world):
    w = open_world
    w.host.express(HAPPY)
    w.run(0.3)
    w.from_robot.cut = True
    w.run(2)
    assert w.telemetry.state == "lost"
    w.from_robot.cut = False
    w.run(0.5)
    assert w.telemetry.acknowledged == HAPPY
    assert (len(w.applied), w.neutral_at) == (1, [])


def test_a_robot_processes_the_time_before_its_input():
    robot = Simulator()
    robot.link.receive(encode_frame(pack(m.Hello(1, 5), 1)), 0.0)
    robot.link.receive(encode_frame(pack(m.Express(1, 0.5, 0), 1)), timing.FAILSAFE_PROMISE)
    assert robot.link.session == 0
    assert robot.body.target == Emotion(0, 0)


def test_close_makes_the_robot_neutral_at_once(open_world):
    w = open_world
    w.host.express(HAPPY)
    w.run(1)
    w.host.close()
    w.run(0.02)
    assert w.robot.body.target == Emotion(0, 0)
    assert w.telemetry.state == "closed"
    w.run(1)
    assert w.host.bytes_to_send() == b""


def test_bytes_that_waited_during_a_stall_have_no_effect(open_world):
    w = open_world
    w.run(0.2)
    w.stalled_until = w.now + 3
    w.host.express(HAPPY)
    w.run(0.3)
    w.host.express(ANGRY)
    w.run(5)
    assert [emotion for _, emotion in w.applied] == [ANGRY]
    assert w.telemetry.acknowledged == ANGRY


# --- The robot side alone, with single messages of a foreign host --------------------------------


class ForeignHost:
    """Says single messages to a robot and reads its answers."""

    def __init__(self) -> None:
        self.robot = Simulator()
        self._reader = FrameReader()

    def say(self, message: object, session: int = 1, now: float = 0.0) -> list[Any]:
        self.robot.receive(encode_frame(pack(message, session)), now)
        return [unpack(b, "robot")[1] for b in self._reader.feed(self.robot.bytes_to_send())]


def test_a_command_that_comes_twice_is_taken_once_and_acknowledged_twice():
    foreign = ForeignHost()
    foreign.say(m.Hello(1, 5))
    assert foreign.say(m.Express(1, 0.5, 0)) == [m.Ack(1, m.RESULT_TAKEN)]
    foreign.say(m.Express(2, -0.5, 0))
    assert foreign.say(m.Express(1, 0.5, 0)) == [m.Ack(1, m.RESULT_TAKEN)]
    assert foreign.robot.body.target.valence == -0.5


def test_a_second_hello_of_the_same_session_changes_nothing():
    foreign = ForeignHost()
    (first,) = foreign.say(m.Hello(1, 5))
    foreign.say(m.Express(1, 0.5, 0))
    (again,) = foreign.say(m.Hello(1, 5))
    assert (first.taken, again.taken) == (0, 1)
    assert foreign.robot.body.target.valence == 0.5


def test_another_host_finds_a_neutral_robot_that_counts_from_one():
    foreign = ForeignHost()
    foreign.say(m.Hello(1, 5))
    foreign.say(m.Express(900, 0.5, 0))
    (welcome,) = foreign.say(m.Hello(1, 6), session=2)
    assert welcome.taken == 0
    assert foreign.robot.body.target == Emotion(0, 0)
    assert foreign.say(m.Express(1, 0.5, 0), session=2) == [m.Ack(1, m.RESULT_TAKEN)]


def test_a_session_that_is_not_open_is_answered_by_gone_at_a_limited_rate():
    foreign = ForeignHost()
    assert foreign.say(m.Express(1, 0.5, 0), session=9, now=0.0) == [m.Gone()]
    assert foreign.say(m.Beat(1), session=9, now=0.01) == []
    assert foreign.say(m.Beat(2), session=9, now=0.02) == [m.Gone()]
    assert foreign.robot.body.target == Emotion(0, 0)


def test_a_newer_host_is_answered_in_the_robots_version():
    (welcome,) = ForeignHost().say(m.Hello(200, 5))
    assert welcome.version == timing.VERSION


def test_a_robot_sends_its_state_without_a_beat():
    foreign = ForeignHost()
    foreign.say(m.Hello(1, 5))
    foreign.robot.advance(timing.STATE_EVERY)
    (body,) = FrameReader().feed(foreign.robot.bytes_to_send())
    assert isinstance(unpack(body, "robot")[1], m.State)
