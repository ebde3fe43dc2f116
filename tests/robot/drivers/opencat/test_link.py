"""The driver for OpenCat against a simulated board: from the first byte to the goodbye."""

import math
from dataclasses import replace
from itertools import pairwise

import pytest

from cubeling.robot.drivers.opencat.echo import MAX_QUESTION_TRIES, QUESTION_TIMEOUT_S
from cubeling.robot.drivers.opencat.host import REST_INTERVAL_S
from cubeling.robot.drivers.opencat.settings import load_settings, parse_settings
from cubeling.robot.protocol import messages as m
from cubeling.robot.simulators.opencat.quirks import BoardQuirks
from cubeling.robot.simulators.opencat.simulator import OpenCatSimulator
from tests.robot.drivers.opencat.boards import HeldBackBoard, UnheardBoard, introduced_host


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


def test_an_error_message_survives_a_restart_of_the_board():
    host = introduced_host()
    host.receive(b"Low power: 6.71V. The robot won't move.\r\n* Start *\r\nReady!\r\n", 3.0)
    assert host.telemetry(3.0).complaint == "Low power: 6.71V. The robot won't move."


def test_a_stopped_robot_that_plays_a_skill_is_not_called_still(desk):
    d = desk().ready()
    d.host.stop()
    d.until(lambda: d.telemetry.stopped, 10.0)
    d.host.play(m.ITEM_MOTION, d.host.catalogue.motions.index("pu"))
    d.until(lambda: d.lines[-1] == "kpu", 5.0)
    assert not d.telemetry.stopped
    d.until(lambda: d.telemetry.stopped, 15.0)


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
    assert d.lines.count("b14 8 18 8 21 8") == 1, "the mood has not begun again"


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
    robot = HeldBackBoard(4, quirks=quiet)
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


def test_a_resting_robot_stays_at_rest_when_its_sign_of_life_is_lost(desk, quiet):
    robot = UnheardBoard(4, quirks=quiet)
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
