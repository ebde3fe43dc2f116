"""What is sent when: the latest mood, each sound and action once, poses at the joints' own pace."""

from pathlib import Path

import pytest

import robot.drivers.pleo
from robot.contract.driver import MAX_QUEUED_ACTIONS
from robot.drivers.pleo import commands, timing
from robot.drivers.pleo.commands import Command
from robot.drivers.pleo.settings import BUNDLED_SETTINGS
from robot.protocol import messages as m

OK = "\r\n> "

STEP = 0.005
"""The link's thread turns this often [s]."""

POSES = """
[moods.neutral]
joints = {}
[moods.angry]
joints = { torso = -9.2, "tail up" = 45, "left hip" = -45, "left shoulder" = 45 }
[moods.sad]
joints = { torso = 8, "left shoulder" = -30 }
[moods.happy]
motion = "a:happy.umf"
length_s = 3
loop = false
"""


@pytest.fixture
def poses(tmp_path, script):
    (tmp_path / "poses.toml").write_text(POSES)
    return script(tmp_path / "poses.toml").started()


def write(folder: Path, text: str) -> Path:
    (folder / "mine.toml").write_text(text)
    return folder / "mine.toml"


def shown(pleo, label: str):
    pleo.express(label)
    pleo.auto(1.0)
    return pleo


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


def test_a_motions_speed_is_sent_only_where_it_changes(script, tmp_path):
    angry = "length_s = 2.0\nsound"
    hasty = BUNDLED_SETTINGS.read_text().replace(angry, f"motion_speed = 150\n{angry}")
    pleo = shown(script(write(tmp_path, hasty)).started(), "happy")
    for word, sent in (
        ("neutral", ["MOTION PLAY a:neutral.umf"]),
        ("angry", ["MOTION SPEED 150", "MOTION PLAY a:angry.umf"]),
        ("neutral", ["MOTION SPEED 100", "MOTION PLAY a:neutral.umf"]),
    ):
        pleo.express(word)
        assert [line for line in pleo.auto(1.0) if line.startswith("MOTION")] == sent


def test_a_mood_begins_at_once_on_an_idle_console_that_need_be_told_nothing_first(script):
    pleo = shown(script().started(), "neutral")
    pleo.express("angry")
    assert pleo.run(STEP) == b"MOTION PLAY a:angry.umf\n"


def test_moods_follow_each_other_no_faster_than_the_settings_say(script):
    pleo = script().started()
    pleo.express("happy")
    assert pleo.auto(0.4)[:2] == ["MOTION SPEED 100", "MOTION PLAY a:happy.umf"]
    pleo.express("angry")
    assert pleo.auto(0.09) == []
    pleo.express("neutral")
    assert pleo.auto(0.5) == ["MOTION PLAY a:neutral.umf", "SOUND PLAY a:neutral.usf"]


def test_the_same_mood_is_not_sent_again_but_what_was_felt_is_acknowledged(script):
    pleo = shown(script().started(), "happy")
    pleo.driver.express(robot.Emotion(0.5, 0.7, "happy"))
    assert pleo.auto(1.0) == []
    assert pleo.telemetry.acknowledged == robot.Emotion(0.5, 0.7, "happy")


def test_a_loop_is_played_again_when_it_has_ended_and_its_sound_is_not(script):
    pleo = shown(script().started(), "happy")
    sent = pleo.auto(10.0)
    assert sent.count("MOTION PLAY a:happy.umf") in (3, 4)  # 3.2 s each
    assert not any(line.startswith("SOUND") for line in sent)
    assert pleo.telemetry.acknowledged is not None


def test_a_motion_that_is_no_loop_is_played_once(poses):
    poses.express("happy")
    sent = poses.auto(10.0)
    assert sent.count("MOTION PLAY a:happy.umf") == 1


def test_a_lost_answer_to_a_moods_motion_sends_it_again(script):
    pleo = script().started()
    pleo.express("happy")
    assert pleo.run(0.1) + pleo.say(OK) == b"MOTION SPEED 100\nMOTION PLAY a:happy.umf\n"
    assert pleo.run(timing.LONG_TIMEOUT_S) == b"\n"
    assert pleo.state == "degraded"
    assert pleo.telemetry.acknowledged is None
    assert pleo.auto(1.0)[:3] == ["APP UNLOAD", "MOTION SPEED 100", "MOTION PLAY a:happy.umf"]
    assert pleo.telemetry.counts.retries == 1
    assert pleo.state == "ready"
    assert pleo.telemetry.acknowledged is not None


def test_a_lost_answer_ends_what_was_acknowledged_before(script):
    pleo = shown(script().started(), "happy")
    pleo.express("neutral")
    assert pleo.run(0.1) == b"MOTION PLAY a:neutral.umf\n"
    assert pleo.run(timing.LONG_TIMEOUT_S) == b"\n"
    assert pleo.telemetry.acknowledged is not None
    assert pleo.say(OK) == b"APP UNLOAD\n"  # it may have restarted
    assert pleo.telemetry.acknowledged is None


def test_a_late_answer_with_text_in_it_is_an_answer_and_nothing_is_sent_again(poses):
    poses.express("happy")
    assert poses.run(0.1) + poses.say(OK) == b"MOTION SPEED 100\nMOTION PLAY a:happy.umf\n"
    assert poses.run(timing.LONG_TIMEOUT_S) == b"\n"
    assert poses.say("playing a:happy.umf\r\n> \r\n> ") == b"APP UNLOAD\n"
    assert poses.auto(10.0) == []
    assert poses.telemetry.counts.retries == 0


def test_a_mood_that_was_lost_and_is_no_longer_wanted_is_not_sent_again(script):
    pleo = script().started()
    pleo.express("happy")
    pleo.run(0.1)
    pleo.say(OK)
    pleo.express("angry")
    pleo.run(timing.LONG_TIMEOUT_S)
    sent = pleo.auto(1.0)
    assert "MOTION PLAY a:angry.umf" in sent
    assert "MOTION PLAY a:happy.umf" not in sent


@pytest.mark.parametrize(("item", "index"), [(m.ITEM_MOTION, 0), (m.ITEM_SOUND, 0)])
def test_an_action_is_sent_once_even_if_its_answer_is_lost(script, item, index):
    pleo = script().started()
    assert pleo.driver.play(item, index)
    sent = pleo.run(0.1)
    assert sent in (b"MOTION PLAY a:nod.umf\n", b"SOUND PLAY a:chirp.usf\n")
    assert pleo.run(timing.LONG_TIMEOUT_S) == b"\n"
    assert pleo.auto(10.0) == ["APP UNLOAD"]
    assert pleo.telemetry.counts.dropped == 1


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
    pleo = shown(script().started(), "happy")
    pleo.driver.play(m.ITEM_MOTION, 0)
    begun = pleo.now
    sent: list[str] = []
    while len(sent) < 2:
        sent += pleo.auto(0.1)
    assert sent == ["MOTION PLAY a:nod.umf", "MOTION PLAY a:happy.umf"]
    assert 2.0 <= pleo.now - begun < 2.2  # a nod lasts 2 s


def test_a_stop_goes_before_everything_and_is_not_repeated(script):
    pleo = shown(script().started(), "happy")
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


def test_an_error_text_is_counted_kept_and_not_fatal(script):
    pleo = script().started()
    pleo.express("happy")
    pleo.run(0.1)
    pleo.say(OK)
    # Pleo's own behaviour may be what refuses.
    assert pleo.say("MC_GetMotorStatus Failed: joint 14\r\n> ") == b"APP UNLOAD\n"
    assert pleo.telemetry.counts.refused == 1
    assert pleo.telemetry.complaint == "MC_GetMotorStatus Failed: joint 14"
    assert pleo.telemetry.acknowledged is None
    pleo.auto(1.0)
    assert pleo.telemetry.acknowledged is None
    assert "MOTION PLAY a:happy.umf" in pleo.auto(3.0)  # the next round of the loop
    assert pleo.telemetry.acknowledged is not None


def test_a_complaint_stands_until_another_mood_is_taken(script):
    pleo = script().started()
    pleo.express("happy")
    pleo.run(0.1)
    for _ in ("MOTION SPEED", "MOTION PLAY", "SOUND SPEED"):
        pleo.say(OK)
    before = pleo.telemetry
    assert before.complaint is None
    pleo.say("Error: file not found:\ta:happy.usf" + "." * 99 + "\r\n> ")
    complaint = pleo.telemetry.complaint
    assert complaint == ("Error: file not found: a:happy.usf" + "." * 99)[:80]
    assert "MOTION PLAY a:happy.umf" in pleo.auto(5.0)
    assert pleo.telemetry.complaint == complaint  # the same mood once more is no news
    pleo.express("neutral")
    pleo.auto(1.0)
    after = pleo.telemetry
    assert after.complaint is None


def test_a_complaint_ends_when_what_was_refused_is_taken_and_with_a_stop(script):
    pleo = shown(script().started(), "neutral")
    pleo.express("happy")
    for end in (lambda: None, pleo.driver.stop):
        pleo.auto(1.0, "Error: invalid parameter\r\n> ")
        pleo.say("MC_GetMotorStatus Failed: joint 14\r\n")
        assert pleo.telemetry.complaint == "MC_GetMotorStatus Failed: joint 14"
        end()
        sent = pleo.auto(4.0)
        assert "MOTION PLAY a:happy.umf" in sent or "JOINT NEUTRAL" in sent
        assert pleo.telemetry.complaint is None


def test_a_motion_that_is_no_loop_and_refused_is_tried_a_few_times(poses):
    poses.express("happy")
    sent = poses.auto(20.0, "Error: file not found\r\n> ")
    assert sent.count("MOTION PLAY a:happy.umf") == timing.MAX_REFUSED_TRIES
    assert poses.telemetry.acknowledged is None
    assert poses.state == "ready"


def test_an_error_while_idle_is_kept_and_begins_nothing_anew(script):
    pleo = shown(script().started(), "happy")
    assert b"APP" not in pleo.say("MC_GetMotorStatus Failed: joint 14\r\n")
    assert pleo.telemetry.complaint == "MC_GetMotorStatus Failed: joint 14"
    assert pleo.telemetry.counts.sessions == 1


@pytest.mark.parametrize("text", ["\r\nPleo Monitor v1.1\r\n> ", "\r\nhello\r\nready\r\n> "])
def test_a_console_that_starts_anew_while_idle_is_begun_with_anew(script, text):
    pleo = shown(script().started(), "happy")
    pleo.say(text, 0.1)
    assert pleo.state == "lost"
    sent = pleo.auto(3.0)
    assert sent[:3] == ["APP UNLOAD", "JOINT NEUTRAL", "SOUND VOLUME 70"]
    assert "MOTION PLAY a:happy.umf" in sent
    assert pleo.telemetry.counts.sessions == 2


def test_a_console_that_starts_anew_inside_an_answer_is_begun_with_anew(script):
    pleo = script().started()
    pleo.express("happy")
    pleo.run(0.1)
    pleo.say(OK)
    pleo.say("Booting\r\n> ", 0.1)
    sent = pleo.auto(3.0)
    assert sent[0] == "APP UNLOAD"
    assert "MOTION PLAY a:happy.umf" in sent


def test_three_lost_answers_in_a_row_end_the_session(script):
    pleo = script().started()
    pleo.express("happy")
    lost = 0
    while pleo.state != "lost":
        if pleo.run(0.05) == b"\n" and pleo.state != "lost":  # only empty lines are answered
            pleo.driver.receive(OK.encode(), pleo.now)
            lost += 1
        assert lost <= timing.MAX_LOST_ANSWERS
    assert lost == timing.MAX_LOST_ANSWERS


def test_after_a_nudge_a_second_prompt_may_be_on_its_way(script):
    pleo = script().started()
    pleo.express("happy")
    assert pleo.run(timing.SHORT_TIMEOUT_S + 0.02) == b"MOTION SPEED 100\n\n"
    assert pleo.say(OK, 0.2) + pleo.say(OK, 0.05) == b""
    assert pleo.run(0.2) == b"APP UNLOAD\n"


def test_a_sound_whose_answer_is_lost_is_not_sent_again_and_nor_is_its_motion(script, tmp_path):
    poses = script(write(tmp_path, "[moods.neutral]\njoints = {}\nsound = 'a:n.usf'\n"))
    poses.started().express("neutral")
    sent = poses.run(0.01).decode()
    while "SOUND PLAY" not in sent:
        sent = poses.say(OK, 0.1).decode()
    assert poses.run(timing.LONG_TIMEOUT_S) == b"\n"
    assert poses.auto(20.0) == ["APP UNLOAD"]
    assert poses.telemetry.acknowledged is not None


def test_what_is_left_of_a_mood_is_not_sent_once_another_is_asked_for(script, tmp_path):
    slowly = BUNDLED_SETTINGS.read_text().replace("mood_every_s = 0.5", "mood_every_s = 5")
    pleo = script(write(tmp_path, slowly)).started()
    pleo.express("happy")
    assert pleo.run(0.1) + pleo.say(OK) == b"MOTION SPEED 100\nMOTION PLAY a:happy.umf\n"
    pleo.express("angry")
    assert pleo.auto(4.0) == []
    assert pleo.auto(1.0)[0] == "MOTION PLAY a:angry.umf"


def test_what_is_acknowledged_stays_until_the_next_mood_is(script):
    pleo = shown(script().started(), "happy")
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
    pleo = shown(script().started(), "happy")
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
    shown(poses, "happy")
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
