"""The driver for OpenCat against a simulated board: from the first byte to the goodbye."""

import math
from dataclasses import replace
from itertools import pairwise

import pytest

from affect import Emotion
from robot.drivers.opencat.echo import MAX_QUESTION_TRIES, QUESTION_TIMEOUT_S
from robot.drivers.opencat.host import REST_INTERVAL_S, OpenCatHost
from robot.drivers.opencat.settings import load_settings, parse_settings
from robot.protocol import messages as m
from robot.simulators.opencat.quirks import BoardQuirks
from robot.simulators.opencat.simulator import OpenCatSimulator, nybble

HAPPY = Emotion(0.7, 0.6, "happy")


def test_a_whole_session_line_by_line(desk):
    d = desk().ready()
    d.feel("happy")
    d.settle()
    d.run(4.0)
    d.feel("sad")
    d.settle()
    d.run(3.0)
    d.host.stop()
    d.until(lambda: d.telemetry.stopped, 10.0)
    d.host.close()
    assert d.host.bytes_to_send() == b"d\n"
    assert d.lines == [
        "?",
        "kbuttUp",
        "b14 8 18 8 21 8",
        "ksit",
        "i0 -40",
        "b16 4 12 4",
        "kbalance",
    ]
    assert [text for _, text in d.robot.log] == d.lines
    assert not d.robot.forbidden


def test_nothing_is_sent_while_the_board_starts_and_then_its_model_is_known(desk):
    d = desk()
    d.until(lambda: d.sent != [], 30.0)
    assert len(d.robot.log) == 0
    d.ready()
    assert d.host.catalogue.name == "Bittle X"
    assert d.host.catalogue.firmware == "OpenCat B10_241013"
    assert len(d.host.catalogue.joints) == 9
    assert d.host.catalogue.moods[0] == "neutral"
    assert d.telemetry.limp, "a board that has just started has let go of its servos"


def test_nybble_is_recognised_with_its_eleven_joints(desk):
    d = desk(nybble(3)).ready()
    assert d.host.catalogue.name == "Nybble"
    names = [joint.name for joint in d.host.catalogue.joints]
    assert len(names) == 11
    assert names[:3] == ["head", "head tilt", "tail"]
    d.feel("happy")
    d.settle()
    assert "i1 20 2 30" in d.lines


@pytest.mark.parametrize("model", ["", "bittle"])
def test_an_old_board_that_reports_no_model_shows_moods_too(model, desk, quiet):
    robot = OpenCatSimulator(1, quirks=replace(quiet, answers_query=False))
    d = desk(robot, parse_settings({"opencat": {"model": model}}, "mine.toml")).ready()
    assert d.host.catalogue.name == "OpenCat"
    assert len(d.host.catalogue.joints) == (9 if model else 0)
    d.feel("happy")
    d.settle()
    assert d.shown == "happy"


def test_another_robot_shows_moods_by_postures_alone(desk):
    d = desk(OpenCatSimulator(1, "DoF16", "C01_250101")).ready()
    assert d.host.catalogue.name == "DoF16"
    assert d.host.catalogue.joints == ()
    d.feel("sad")
    d.settle()
    assert not any(line.startswith("i") for line in d.lines)


def test_a_board_that_asks_whether_to_erase_its_calibration_gets_no_byte(desk, quiet):
    robot = OpenCatSimulator(2, quirks=quiet, new_board=True)
    d = desk(robot)
    d.feel("happy")
    d.run(120.0)
    assert d.sent == []
    assert d.state == "connecting"
    robot.receive(b"n", d.now)  # its owner answers, in Petoi's own program
    d.ready()
    d.settle()
    assert not robot.forbidden
    d.host.close()


def test_a_board_that_asks_gets_no_rest_command_at_close(desk, quiet):
    d = desk(OpenCatSimulator(2, quirks=quiet, new_board=True))
    d.run(30.0)
    d.host.close()
    assert d.host.bytes_to_send() == b""


def test_a_board_that_did_not_restart_is_asked_after_a_second(desk):
    d = desk()
    d.robot.advance(90.0)
    d.robot.advance(99.0)
    d.robot.bytes_to_send()
    assert d.until(lambda: d.state == "ready", 5.0) < 1.2
    assert not d.telemetry.limp


def test_the_last_of_many_moods_wins(desk):
    d = desk().ready()
    for index in range(500):
        d.feel(["happy", "angry", "sad"][index % 3])
        d.turn()
    d.feel("angry")
    d.settle()
    assert d.shown == "angry"
    skills = [at for at, line in d.sent if line[0] == "k"]
    assert len(skills) < 12
    gaps = [after - before for before, after in pairwise(skills)]
    assert min(gaps) >= load_settings().dwell


def test_the_same_mood_again_is_not_sent_again_but_counts_as_taken(desk):
    d = desk().ready()
    d.feel("happy")
    d.settle()
    d.run(1.0)
    before = len(d.sent)
    d.host.express(Emotion(0.8, 0.7, "happy"))
    assert d.telemetry.acknowledged == Emotion(0.8, 0.7, "happy")
    d.run(2.0)
    assert len(d.sent) == before


def test_nothing_is_acknowledged_before_the_robot_is_there(desk):
    d = desk().ready()
    d.feel("sad")
    while d.telemetry.acknowledged is None:
        assert d.telemetry.commanded is not None
        d.turn()
    assert d.shown == "sad"
    assert d.telemetry.observed is None
    assert d.telemetry.label is None
    assert d.telemetry.battery is None


def test_what_is_acknowledged_stays_until_the_next_mood_is(desk):
    d = desk().ready()
    d.feel("happy")
    d.settle()
    d.host.express(Emotion(0.8, 0.7, "happy"))
    d.feel("sad")  # a posture, and then a pose
    while d.telemetry.acknowledged != Emotion(-0.6, -0.4, "sad"):
        assert d.telemetry.acknowledged == Emotion(0.8, 0.7, "happy")
        d.turn()
    assert "i0 -40" in d.lines
    d.host.stop()
    d.until(lambda: d.telemetry.stopped, 10.0)
    assert d.telemetry.acknowledged is None


def test_an_emotion_is_not_acknowledged_while_another_posture_is_pending(desk):
    d = desk().ready()
    d.feel("happy")
    d.settle()
    d.feel("neutral")
    d.until(lambda: d.lines[-1] == "kbalance", 5.0)
    for valence in (0.8, 0.9):  # happy again, but it has left that posture
        d.host.express(Emotion(valence, 0.6, "happy"))
        assert d.telemetry.acknowledged == HAPPY
    d.until(lambda: d.telemetry.acknowledged != HAPPY, 5.0)
    assert d.telemetry.acknowledged == Emotion(0.0, 0.0, "neutral"), (
        "its echo came, displaced or not"
    )
    d.settle()
    assert d.telemetry.acknowledged == Emotion(0.9, 0.6, "happy")


def test_the_last_emotion_of_a_displaced_mood_is_acknowledged_with_its_echo(desk):
    d = desk().ready()
    d.feel("happy")
    d.until(lambda: d.lines[-1] == "kbuttUp", 5.0)
    d.host.express(Emotion(0.9, 0.7, "happy"))
    d.feel("neutral")
    d.until(lambda: d.telemetry.acknowledged is not None, 5.0)
    assert d.telemetry.acknowledged == Emotion(0.9, 0.7, "happy")


def test_half_of_a_displaced_mood_is_not_acknowledged(desk):
    d = desk().ready()
    d.feel("happy")
    d.settle()
    d.feel("sad")
    d.until(lambda: d.lines[-1] == "ksit", 5.0)
    d.feel("angry")
    while d.telemetry.acknowledged == HAPPY:
        d.turn()
    assert d.telemetry.acknowledged == Emotion(-0.7, 0.6, "angry")
    assert "i0 -40" not in d.lines


def test_an_error_message_survives_a_restart_of_the_board():
    host = _introduced()
    host.receive(b"Low power: 6.71V. The robot won't move.\r\n* Start *\r\nReady!\r\n", 3.0)
    assert host.telemetry(3.0).complaint == "Low power: 6.71V. The robot won't move."


def test_a_fall_clears_what_is_acknowledged():
    host = _introduced()
    host.express(HAPPY)
    host.tick(3.0)
    host.bytes_to_send()
    host.receive(b"k\r\n", 3.5)
    assert host.telemetry(3.5).acknowledged == HAPPY
    host.receive(b"EXCEPTION: Fall over\r\n", 3.6)
    known = host.telemetry(3.6)
    assert (known.acknowledged, known.complaint) == (None, "EXCEPTION: Fall over")


def test_a_stopped_robot_that_plays_a_skill_is_not_called_still(desk):
    d = desk().ready()
    d.host.stop()
    d.until(lambda: d.telemetry.stopped, 10.0)
    d.host.play(m.ITEM_MOTION, d.host.catalogue.motions.index("pu"))
    d.until(lambda: d.lines[-1] == "kpu", 5.0)
    assert not d.telemetry.stopped
    d.until(lambda: d.telemetry.stopped, 15.0)


class Deaf(OpenCatSimulator):
    """A board whose echoes can be held back, as if it were busy."""

    held = False

    def bytes_to_send(self) -> bytes:
        return b"" if self.held else super().bytes_to_send()


def test_a_late_echo_counts_for_its_own_command_and_for_no_later_one(desk, quiet):
    robot = Deaf(4, quirks=quiet)
    d = desk(robot).ready()
    d.feel("happy")
    d.run(0.3)
    robot.held = True  # the echo of "kbuttUp" is kept back
    d.feel("sad")
    d.run(5.0)
    assert d.state == "degraded"
    assert d.lines[-2:] == ["kbuttUp", "j"]
    robot.held = False
    d.until(lambda: "ksit" in d.lines, 5.0)
    assert d.telemetry.acknowledged == HAPPY, "the late echo was the happy posture's"
    d.settle()
    assert d.telemetry.acknowledged == Emotion(-0.6, -0.4, "sad")
    assert d.lines.count("kbuttUp") == 1


def test_an_echo_after_the_questions_is_not_the_given_up_commands(desk, quiet):
    host = OpenCatHost()
    host.port_opened(0.0)
    host.tick(2.0)
    assert host.bytes_to_send() == b"?\n"
    host.receive(b"Bittle\r\nN11_230101\r\n?\r\n", 2.1)
    host.express(HAPPY)
    host.tick(3.0)
    assert host.bytes_to_send() == b"kbuttUp\n"
    host.tick(8.5)
    assert host.bytes_to_send() == b"j\n", "its echo is late"
    host.tick(8.5 + QUESTION_TIMEOUT_S)
    assert host.bytes_to_send() == b"j\n", "a question is repeated with the same token"
    host.receive(b"?\r\n", 10.6)  # the late echo of some earlier question settles nothing
    host.tick(10.7)
    assert host.bytes_to_send() == b""
    host.receive(b"j\r\n", 10.8)  # now the command is known to be lost
    assert host.telemetry(10.8).acknowledged is None
    host.tick(13.0)
    assert host.bytes_to_send() == b"kbuttUp\n"
    host.receive(b"j\r\n", 13.1)  # the echo of the repeated question: late, and harmless
    assert host.telemetry(13.1).acknowledged is None
    host.receive(b"k\r\n", 13.2)
    assert host.telemetry(13.2).acknowledged == HAPPY


def test_the_echo_of_a_skill_after_a_fall_is_ignored():
    host = OpenCatHost()
    host.port_opened(0.0)
    host.tick(2.0)
    host.receive(b"Bittle X\r\nB10_241013\r\n?\r\n", 2.1)
    host.express(HAPPY)
    host.tick(3.0)
    host.bytes_to_send()
    host.receive(
        b"EXCEPTION: Fall over\r\nk\r\n", 3.1
    )  # it was on its way already: its own skill's
    assert host.telemetry(3.1).acknowledged is None
    host.tick(3.4)
    assert host.bytes_to_send() == b"j\n"
    host.receive(b"k\r\nj\r\n", 4.0)
    assert host.telemetry(4.0).acknowledged is None
    host.tick(6.0)
    assert host.bytes_to_send() == b"kbuttUp\n"
    host.receive(b"k\r\n", 6.5)
    assert host.telemetry(6.5).acknowledged == HAPPY


def test_a_reboot_in_the_middle_is_noticed_and_the_mood_is_taken_again(desk):
    d = desk().ready()
    d.feel("happy")
    d.settle()
    d.robot.reboot()
    d.until(lambda: d.telemetry.acknowledged is None, 2.0)
    assert d.telemetry.limp
    assert d.state == "lost"
    d.settle()
    assert d.shown == "happy"
    assert d.telemetry.counts.sessions == 2
    assert d.lines.count("b14 8 18 8 21 8") == 1, "the mood has not begun anew"


def test_the_k_of_a_starting_board_is_no_echo(desk):
    d = desk().ready()
    d.feel("happy")
    d.until(lambda: "kbuttUp" in d.lines, 5.0)
    d.robot.reboot()  # a brown-out, as the servos begin to move
    d.run(1.5)
    assert d.telemetry.acknowledged is None
    d.settle()
    assert d.lines.count("kbuttUp") == 2


def test_unplugging_and_plugging_is_recovered_from(desk):
    d = desk().ready()
    d.feel("happy")
    d.settle()
    d.unplug()
    assert d.state == "lost"
    assert d.telemetry.acknowledged is None
    d.feel("sad")
    d.run(10.0)
    d.plug()
    d.settle()
    assert d.shown == "sad"


def test_a_silent_board_is_lost_within_the_stated_time_and_found_again(desk, quiet):
    robot = Deaf(4, quirks=quiet)
    d = desk(robot).ready()
    d.feel("happy")
    d.settle()
    d.run(1.0)
    robot.held = True
    bound = load_settings().ask_every + MAX_QUESTION_TRIES * QUESTION_TIMEOUT_S + 0.5
    d.until(lambda: d.state == "degraded", bound)
    d.until(lambda: d.state == "lost", bound)
    assert d.telemetry.acknowledged is None
    robot.held = False
    d.settle()
    assert d.state == "ready"


def test_gestures_are_played_at_their_interval_and_the_posture_is_taken_again(desk):
    d = desk().ready()
    d.feel("happy")
    d.settle()
    d.run(65.0)
    waves = [at for at, line in d.sent if line == "khi"]
    assert len(waves) == 3
    assert min(b - a for a, b in pairwise(waves)) >= 20.0 - 1e-6
    assert d.lines.count("kbuttUp") == 4
    assert d.telemetry.acknowledged is not None


def test_an_idle_robot_lies_down_and_wakes_for_a_new_mood(desk):
    d = desk().ready()
    d.feel("happy")
    d.settle()
    d.until(lambda: d.telemetry.limp, 130.0)
    assert d.lines[-1] == "d"
    assert not d.robot.body.powered
    assert d.telemetry.acknowledged is None
    d.run(3 * REST_INTERVAL_S)
    assert set(d.lines[-3:]) == {"d"}, "no other question: it would switch balancing on"
    assert d.state == "ready"
    d.feel("happy")  # nothing new: it is let lie
    d.run(5.0)
    assert d.telemetry.limp
    d.feel("sad")
    d.settle()
    assert d.shown == "sad"
    assert not d.telemetry.limp


def test_a_robot_with_a_low_battery_is_limp_and_gets_no_moving_commands(desk, quiet):
    d = desk(OpenCatSimulator(1, quirks=replace(quiet, battery_lasts=30.0))).ready()
    d.feel("happy")
    d.settle()
    d.until(lambda: d.telemetry.limp, 40.0)
    d.feel("sad")
    before = len([line for line in d.lines if line[0] == "k"])
    d.run(300.0)
    assert len([line for line in d.lines if line[0] == "k"]) == before
    assert d.telemetry.acknowledged is None
    d.until(lambda: d.telemetry.acknowledged is not None, 340.0)
    assert d.shown == "sad"
    assert not d.telemetry.limp


def test_an_unknown_skill_is_counted_and_given_up(desk):
    said = {"bittle": {"moods": {"happy": {"posture": "zz"}}}}
    d = desk(settings=parse_settings(said, "mine.toml")).ready()
    d.feel("angry")
    d.settle()
    d.feel("happy")
    d.until(lambda: d.telemetry.counts.refused == 1, 5.0)
    assert d.telemetry.acknowledged is None
    d.run(30.0)
    assert d.lines.count("kzz") == 2
    assert d.telemetry.counts.refused == 2
    assert d.telemetry.acknowledged is None
    assert d.telemetry.complaint == "?zz?"
    d.feel("sad")
    d.settle()
    assert d.telemetry.complaint is None


def test_motions_and_sounds_are_played_once_and_only_while_there_is_a_link(desk):
    d = desk()
    assert d.host.play(m.ITEM_MOTION, 0)
    d.ready()
    motions, sounds = d.host.catalogue.motions, d.host.catalogue.sounds
    assert d.host.play(m.ITEM_MOTION, motions.index("pu"))
    assert d.host.play(m.ITEM_SOUND, sounds.index("growl"))
    d.until(lambda: d.telemetry.motion == "pu", 3.0)
    d.until(lambda: d.telemetry.sound == "growl", 10.0)
    d.run(20.0)
    assert d.lines.count("kpu") == 1
    assert d.lines.count("b2 4 1 4") == 1
    assert d.telemetry.counts.dropped == 1
    assert [d.host.play(m.ITEM_MOTION, 0) for _ in range(5)] == [True] * 4 + [False]
    d.host.stop()
    d.run(10.0)
    assert d.lines.count("khi") <= 1
    assert d.telemetry.counts.dropped >= 4


def test_joint_angles_are_read_in_radians_and_marked_as_calculated(desk):
    d = desk().ready()
    d.feel("sad")
    d.settle()
    d.until(lambda: d.telemetry.joints != {}, 40.0)
    angles = d.robot.body.angles(d.now)
    assert d.telemetry.joints["head"] == pytest.approx(math.radians(-40))
    assert d.telemetry.joints["left back knee"] == pytest.approx(math.radians(angles[15]), abs=0.01)
    assert d.telemetry.reckoned


def test_an_idle_line_is_kept_alive_but_a_beeping_board_is_not_asked_more_often(desk):
    d = desk().ready()
    d.run(101.0)
    assert 9 <= len(d.sent) - 1 <= 10
    assert {"?", "j"} == set(d.lines)
    assert d.telemetry.silence < 11.0


def test_nothing_is_sent_or_processed_after_close(desk):
    d = desk().ready()
    d.feel("happy")
    d.host.close()
    assert d.host.bytes_to_send() == b"d\n"
    d.feel("sad")
    d.host.stop()
    d.run(10.0)
    assert d.lines == ["?"]
    assert d.state == "closed"
    d.host.close()
    assert d.host.bytes_to_send() == b""


def test_lines_are_never_sent_so_close_that_the_board_merges_them(desk):
    quirks = BoardQuirks(slow=1.0, brown_outs=0.0, mangled=0.0, restless=0.0)
    d = desk(OpenCatSimulator(5, quirks=quirks)).ready()
    for word in ("happy", "sad", "angry", "neutral", "happy"):
        d.feel(word)
        d.run(6.0)
    assert all("\n" not in text for _, text in d.robot.log)
    assert d.shown == "happy"


def _introduced(at: float = 2.0) -> OpenCatHost:
    """Make a host whose board has introduced itself, and that was asked nothing since."""
    host = OpenCatHost()
    host.port_opened(at - 2.0)
    host.tick(at)
    assert host.bytes_to_send() == b"?\n"
    host.receive(b"Bittle X\r\nB10_241013\r\n?\r\n", at)
    return host


def test_a_question_asked_before_a_fall_does_not_end_the_doubt():
    host = _introduced()
    host.tick(13.0)
    assert host.bytes_to_send() == b"j\n"
    host.express(HAPPY)
    host.receive(b"EXCEPTION: Fall over\r\nj\r\n", 13.1)
    host.tick(14.0)
    assert host.bytes_to_send() == b"?\n", "not the posture yet: another echo is to come"
    host.receive(b"k\r\nBittle X\r\nB10_241013\r\n?\r\n", 15.0)
    host.tick(16.0)
    assert host.bytes_to_send() == b"kbuttUp\n"


def test_an_echo_from_a_board_without_power_is_no_acknowledgement():
    host = _introduced()
    host.express(HAPPY)
    host.tick(3.0)
    assert host.bytes_to_send() == b"kbuttUp\n"
    host.receive(b"Low power: 6.71V. The robot won't move.\r\nk\r\n", 3.5)
    assert host.telemetry(3.5).acknowledged is None
    assert host.telemetry(3.5).limp
    assert host.telemetry(3.5).complaint == "Low power: 6.71V. The robot won't move."
    host.receive(b"Got 7.9 V power\r\n", 6.0)
    assert host.telemetry(6.0).complaint is None
    host.tick(6.0)
    assert host.bytes_to_send() == b"kbuttUp\n"


def test_an_answer_to_a_question_before_the_unplugging_is_ignored():
    host = _introduced()
    host.tick(13.0)
    assert host.bytes_to_send() == b"j\n"
    host.port_lost()
    host.port_opened(14.0)
    host.tick(15.5)
    assert host.bytes_to_send() == b"?\n"
    host.receive(b"j\r\n", 15.6)
    assert host.state(15.6) == "lost"
    host.receive(b"Bittle X\r\nB10_241013\r\n?\r\n", 15.7)
    assert host.state(15.7) == "ready"


class Unheard(OpenCatSimulator):
    """A board whose words can be lost on the way."""

    held = False

    def bytes_to_send(self) -> bytes:
        said = super().bytes_to_send()
        return b"" if self.held else said


def test_a_resting_robot_stays_at_rest_when_its_sign_of_life_is_lost(desk, quiet):
    robot = Unheard(4, quirks=quiet)
    d = desk(robot).ready()
    d.feel("happy")
    d.settle()
    d.until(lambda: d.telemetry.limp, 140.0)
    before = len(d.sent)
    robot.held = True
    d.until(lambda: d.state == "lost", REST_INTERVAL_S + 15.0)
    robot.held = False
    d.until(lambda: d.state == "ready", 5.0)
    d.run(2 * REST_INTERVAL_S)
    assert not any(line[0] == "k" for line in d.lines[before:])
    assert not robot.body.powered
    assert d.telemetry.limp
