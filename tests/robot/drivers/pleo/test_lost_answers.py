"""Answers that are lost, late or errors, and a console that restarts."""

import pytest

from cubeling.robot.drivers.pleo import timing
from cubeling.robot.protocol import messages as m

OK = "\r\n> "


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
    pleo = script().started().show("happy")
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


def test_a_sound_whose_answer_is_lost_is_not_sent_again_and_nor_is_its_motion(
    script, settings_file
):
    poses = script(settings_file("[moods.neutral]\njoints = {}\nsound = 'a:n.usf'\n"))
    poses.started().express("neutral")
    sent = poses.run(0.01).decode()
    while "SOUND PLAY" not in sent:
        sent = poses.say(OK, 0.1).decode()
    assert poses.run(timing.LONG_TIMEOUT_S) == b"\n"
    assert poses.auto(20.0) == ["APP UNLOAD"]
    assert poses.telemetry.acknowledged is not None


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
    pleo = script().started().show("neutral")
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


def test_an_error_while_idle_is_kept_and_restarts_nothing(script):
    pleo = script().started().show("happy")
    assert b"APP" not in pleo.say("MC_GetMotorStatus Failed: joint 14\r\n")
    assert pleo.telemetry.complaint == "MC_GetMotorStatus Failed: joint 14"
    assert pleo.telemetry.counts.sessions == 1


@pytest.mark.parametrize("text", ["\r\nPleo Monitor v1.1\r\n> ", "\r\nhello\r\nready\r\n> "])
def test_a_console_that_restarts_while_idle_is_started_again(script, text):
    pleo = script().started().show("happy")
    pleo.say(text, 0.1)
    assert pleo.state == "lost"
    sent = pleo.auto(3.0)
    assert sent[:3] == ["APP UNLOAD", "JOINT NEUTRAL", "SOUND VOLUME 70"]
    assert "MOTION PLAY a:happy.umf" in sent
    assert pleo.telemetry.counts.sessions == 2


def test_a_console_that_restarts_inside_an_answer_is_started_again(script):
    pleo = script().started()
    pleo.express("happy")
    pleo.run(0.1)
    pleo.say(OK)
    pleo.say("Booting\r\n> ", 0.1)
    sent = pleo.auto(3.0)
    assert sent[0] == "APP UNLOAD"
    assert "MOTION PLAY a:happy.umf" in sent
