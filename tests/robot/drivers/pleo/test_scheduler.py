"""What is sent when: the latest mood, each sound and action once, poses at the joints' own pace."""

import pytest

from cubeling import robot
from cubeling.robot.contract.driver import MAX_QUEUED_ACTIONS
from cubeling.robot.drivers.pleo import commands
from cubeling.robot.drivers.pleo.commands import Command
from cubeling.robot.drivers.pleo.settings import BUNDLED_SETTINGS
from cubeling.robot.protocol import messages as m

OK = "\r\n> "

STEP_S = 0.005
"""The link's thread turns this often [s]."""


def test_every_command_is_on_the_list_and_made_in_one_place(allowed):
    made = [commands.NUDGE, commands.APP_UNLOAD, commands.JOINT_NEUTRAL, commands.STATS_POWER]
    made += [commands.joint_move(13, -80), commands.motion_play("a:x.umf", 1.0)]
    made += [commands.sound_play("a:x.usf", 1.0), commands.motion_speed(100)]
    made += [commands.sound_speed(100), commands.sound_volume(0)]
    assert all(allowed.fullmatch(command.text) for command in made)
    makers = {name for name, one in vars(commands).items() if callable(one) and name != "dataclass"}
    constants = {name for name, one in vars(commands).items() if isinstance(one, Command)}
    assert makers - {"Command", "_setting"} == {
        "joint_move", "motion_play", "motion_speed", "sound_play", "sound_speed", "sound_volume",
    }  # fmt: skip
    assert constants == {"NUDGE", "APP_UNLOAD", "JOINT_NEUTRAL", "STATS_POWER"}


def test_of_the_moods_asked_for_while_the_console_is_busy_only_the_last_is_sent(script):
    pleo = script().started()
    pleo.express("happy")
    assert pleo.run(0.1) == b"MOTION SPEED 100\n"
    for label in ("angry", "neutral", "angry"):
        pleo.express(label)
        assert pleo.run(0.3) == b""
    assert pleo.auto(1.0) == [
        "MOTION PLAY a:angry.umf",
        "SOUND SPEED 100",
        "SOUND PLAY a:angry.usf",
    ]


def test_a_motions_speed_is_sent_only_where_it_changes(script, settings_file):
    angry = "length_s = 2.0\nsound"
    hasty = BUNDLED_SETTINGS.read_text().replace(angry, f"motion_speed = 150\n{angry}")
    pleo = script(settings_file(hasty)).started().show("happy")
    for word, sent in (
        ("neutral", ["MOTION PLAY a:neutral.umf"]),
        ("angry", ["MOTION SPEED 150", "MOTION PLAY a:angry.umf"]),
        ("neutral", ["MOTION SPEED 100", "MOTION PLAY a:neutral.umf"]),
    ):
        pleo.express(word)
        assert [line for line in pleo.auto(1.0) if line.startswith("MOTION")] == sent


def test_a_mood_begins_at_once_on_an_idle_console_that_need_be_told_nothing_first(script):
    pleo = script().started().show("neutral")
    pleo.express("angry")
    assert pleo.run(STEP_S) == b"MOTION PLAY a:angry.umf\n"


def test_moods_follow_each_other_no_faster_than_the_settings_say(script):
    pleo = script().started()
    pleo.express("happy")
    assert pleo.auto(0.4)[:2] == ["MOTION SPEED 100", "MOTION PLAY a:happy.umf"]
    pleo.express("angry")
    assert pleo.auto(0.09) == []
    pleo.express("neutral")
    assert pleo.auto(0.5) == ["MOTION PLAY a:neutral.umf", "SOUND PLAY a:neutral.usf"]


def test_the_same_mood_is_not_sent_again_but_what_was_felt_is_acknowledged(script):
    pleo = script().started().show("happy")
    pleo.driver.express(robot.Emotion(0.5, 0.7, "happy"))
    assert pleo.auto(1.0) == []
    assert pleo.telemetry.acknowledged == robot.Emotion(0.5, 0.7, "happy")


def test_a_loop_is_played_again_when_it_has_ended_and_its_sound_is_not(script):
    pleo = script().started().show("happy")
    sent = pleo.auto(10.0)
    assert sent.count("MOTION PLAY a:happy.umf") in (3, 4)  # 3.2 s each
    assert not any(line.startswith("SOUND") for line in sent)
    assert pleo.telemetry.acknowledged is not None


def test_a_motion_that_is_no_loop_is_played_once(poses):
    poses.express("happy")
    sent = poses.auto(10.0)
    assert sent.count("MOTION PLAY a:happy.umf") == 1


def test_too_many_actions_are_refused_and_those_without_a_session_are_dropped(script):
    pleo = script()
    assert pleo.driver.play(m.ITEM_SOUND, 0)
    assert pleo.telemetry.counts.dropped == 1
    pleo.started()
    taken = [pleo.driver.play(m.ITEM_MOTION, 1) for _ in range(MAX_QUEUED_ACTIONS + 1)]
    assert taken == [True] * MAX_QUEUED_ACTIONS + [False]
    pleo.driver.port_lost()
    assert pleo.telemetry.counts.dropped == 1 + MAX_QUEUED_ACTIONS


def test_after_an_action_the_moods_loop_returns(script):
    pleo = script().started().show("happy")
    pleo.driver.play(m.ITEM_MOTION, 0)
    begun = pleo.now
    sent: list[str] = []
    while len(sent) < 2:
        sent += pleo.auto(0.1)
    assert sent == ["MOTION PLAY a:nod.umf", "MOTION PLAY a:happy.umf"]
    assert 2.0 <= pleo.now - begun < 2.2  # a nod lasts 2 s


def test_a_stop_goes_before_everything_and_is_not_repeated(script):
    pleo = script().started().show("happy")
    pleo.driver.play(m.ITEM_SOUND, 0)
    pleo.driver.stop()
    assert pleo.auto(0.5) == ["JOINT NEUTRAL"]
    known = pleo.telemetry
    assert (known.stopped, known.commanded, known.acknowledged) == (True, None, None)
    assert known.counts.dropped == 1
    pleo.driver.stop()
    assert pleo.auto(5.0) == []
    pleo.driver.play(m.ITEM_MOTION, 0)
    assert pleo.auto(0.5) == ["MOTION PLAY a:nod.umf"]
    assert not pleo.telemetry.stopped
    pleo.driver.stop()
    assert pleo.auto(0.5) == ["JOINT NEUTRAL"]
    pleo.express("happy")
    assert "MOTION PLAY a:happy.umf" in pleo.auto(1.0)
    assert not pleo.telemetry.stopped


def test_what_is_left_of_a_mood_is_not_sent_once_another_is_asked_for(script, settings_file):
    slowly = BUNDLED_SETTINGS.read_text().replace("mood_every_s = 0.5", "mood_every_s = 5")
    pleo = script(settings_file(slowly)).started()
    pleo.express("happy")
    assert pleo.run(0.1) + pleo.say(OK) == b"MOTION SPEED 100\nMOTION PLAY a:happy.umf\n"
    pleo.express("angry")
    assert pleo.auto(4.0) == []
    assert pleo.auto(1.0)[0] == "MOTION PLAY a:angry.umf"


def test_what_is_acknowledged_stays_until_the_next_mood_is(script):
    pleo = script().started().show("happy")
    felt = pleo.telemetry.acknowledged
    assert felt is not None
    pleo.driver.express(robot.Emotion(0.1, 0.2, "neutral"))
    assert pleo.run(0.1) == b"MOTION PLAY a:neutral.umf\n"
    assert pleo.telemetry.acknowledged == felt
    pleo.say(OK)
    assert pleo.telemetry.acknowledged == robot.Emotion(0.1, 0.2, "neutral")
    pleo.driver.stop()
    pleo.auto(0.5)
    assert pleo.telemetry.acknowledged is None


def test_what_is_felt_while_another_mood_is_on_its_way_is_not_acknowledged_yet(script):
    pleo = script().started().show("happy")
    felt = pleo.telemetry.acknowledged
    pleo.express("neutral")
    assert pleo.run(0.1) == b"MOTION PLAY a:neutral.umf\n"
    for valence in (0.6, 0.7):  # happy again, but neutral may play by now
        pleo.driver.express(robot.Emotion(valence, 0.5, "happy"))
        assert pleo.telemetry.acknowledged == felt
    assert pleo.say(OK, 0.5) == b"MOTION PLAY a:happy.umf\n"
    assert pleo.telemetry.acknowledged == robot.Emotion(0.0, 0.0, "neutral")
    pleo.say(OK)
    assert pleo.telemetry.acknowledged == robot.Emotion(0.7, 0.5, "happy")


def test_half_a_pose_is_no_acknowledgement_of_it_and_ends_the_one_before(poses):
    poses.express("angry")
    poses.auto(5.0)
    poses.driver.express(robot.Emotion(-0.6, -0.4, "sad"))
    assert b"JOINT MOVE" in poses.run(0.1)
    assert b"JOINT MOVE" in poses.say(OK)
    for valence in (-0.8, -0.9):
        poses.driver.express(robot.Emotion(valence, 0.5, "angry"))
        assert poses.telemetry.acknowledged == robot.Emotion(0.0, 0.0, "angry")
        poses.say(OK, 0.1)
    poses.auto(5.0)
    assert poses.telemetry.acknowledged == robot.Emotion(-0.9, 0.5, "angry")


def test_an_action_waits_until_the_one_before_has_ended(script):
    pleo = script().started()
    pleo.driver.play(m.ITEM_MOTION, 0)
    pleo.driver.play(m.ITEM_MOTION, 1)
    assert pleo.auto(1.9) == ["MOTION PLAY a:nod.umf"]
    assert pleo.auto(0.3) == ["MOTION PLAY a:wag.umf"]


def test_a_pose_is_sent_within_limits_and_on_steps(poses):
    poses.express("angry")
    sent = poses.auto(3.0)
    moves = sorted(line for line in sent if line.startswith("JOINT"))
    assert moves == [
        "JOINT MOVE 10 45", "JOINT MOVE 2 45", "JOINT MOVE 4 -40", "JOINT MOVE 8 -10",
    ]  # fmt: skip
    assert poses.telemetry.acknowledged is not None


def test_a_joint_gets_no_new_angle_before_it_can_be_where_it_was_sent(poses):
    poses.express("angry")
    times: list[tuple[float, str]] = []
    for number in range(200):
        if number == 60:
            poses.express("sad")
        times += [(poses.now, line) for line in poses.auto(0.02) if "JOINT MOVE 2 " in line]
    (first, one), (second, other) = times
    assert (one, other) == ("JOINT MOVE 2 45", "JOINT MOVE 2 -30")
    assert second - first == pytest.approx(45 / 30, abs=0.1)  # 45° from neutral at 30 °/s


def test_joints_that_a_pose_does_not_name_go_back_to_neutral(poses):
    poses.express("angry")
    poses.auto(3.0)
    poses.express("neutral")
    sent = poses.auto(3.0)
    moves = sorted(line for line in sent if line.startswith("JOINT"))
    assert moves == ["JOINT MOVE 10 0", "JOINT MOVE 2 0", "JOINT MOVE 4 0", "JOINT MOVE 8 0"]


def test_a_pose_after_a_motion_begins_from_neutral(poses):
    poses.show("happy")
    poses.express("sad")
    sent = poses.auto(3.0)
    assert [line for line in sent if "JOINT" in line] == [
        "JOINT NEUTRAL", "JOINT MOVE 2 -30", "JOINT MOVE 8 8",
    ]  # fmt: skip


def test_an_idle_console_is_asked_for_its_prompt_and_now_and_then_for_its_battery(script):
    pleo = script().started()
    before = pleo.telemetry.counts.frames_sent
    assert pleo.auto(62.0) == ["STATS POWER"] * 2  # every 30 s, and the first was at the start
    assert 55 <= pleo.telemetry.counts.frames_sent - before <= 62
    assert 0 <= (pleo.telemetry.round_trip or -1) < 0.2
