"""The very bytes of a start and of a mood change, and what the link says of itself meanwhile."""

from cubeling.affect import Emotion

HAPPY = Emotion(0.8, 0.5, "happy")


def test_the_bytes_of_a_start(script):
    pleo = script()
    assert pleo.state == "connecting"
    assert pleo.run(0.1) == b"\n"
    assert pleo.say("app: drive 3 satisfied\r\nmu: sensor 1 = 0\r\n> ") == b"APP UNLOAD\n"
    assert pleo.say("APP UNLOAD\r\nUnloading ...\r\ndone\r\n>", 0.1) == b""
    assert pleo.say(" ") == b"JOINT NEUTRAL\n"
    assert pleo.say("JOINT NEUTRAL\r\n> ") == b"SOUND VOLUME 70\n"
    assert pleo.state == "connecting"
    assert pleo.say("SOUND VOLUME 70\r\n> ", 0.1) == b"STATS POWER\n"
    assert pleo.state == "ready"
    catalogue = pleo.driver.catalogue
    assert catalogue is not None
    assert catalogue.moods == ("neutral", "happy", "angry")
    assert pleo.say("STATS POWER\r\nBattery sensor value = 57 (584 raw)\r\n> ", 0.1) == b""
    assert pleo.telemetry.battery == 0.57
    assert pleo.telemetry.counts.sessions == 1


def test_the_bytes_of_a_mood_change(script):
    pleo = script().started()
    pleo.driver.express(HAPPY)
    assert pleo.run(0.005) == b"MOTION SPEED 100\n"  # at once: the prompt is free
    assert pleo.say("> ", 0.1) == b"MOTION PLAY a:happy.umf\n"
    known = pleo.telemetry
    assert (known.commanded, known.acknowledged) == (HAPPY, None)
    assert pleo.say("playing a:happy.umf\r\n> ", 0.1) == b"SOUND SPEED 100\n"
    assert pleo.telemetry.acknowledged == HAPPY
    assert pleo.say("> ", 0.1) == b"SOUND PLAY a:happy.usf\n"
    assert pleo.say("> ", 0.1) == b""
    pleo.driver.express(Emotion(-0.9, 0.9))
    assert pleo.run(0.5) == b"MOTION PLAY a:angry.umf\n"
    assert pleo.say("> ", 0.1) == b"SOUND PLAY a:angry.usf\n"
    assert pleo.telemetry.acknowledged == Emotion(-0.9, 0.9)


def test_telemetry_claims_nothing_that_the_console_does_not_report(script):
    pleo = script().started()
    pleo.express("happy")
    for _ in range(4):
        pleo.say("> ")
    known = pleo.telemetry
    assert known.acknowledged is not None
    assert (known.observed, known.label, known.motion, known.sound) == (None, None, None, None)
    assert dict(known.joints) == {}


def test_the_goodbye_leaves_pleo_in_its_neutral_pose_if_the_prompt_is_free(script):
    pleo = script().started()
    pleo.driver.close()
    assert pleo.driver.bytes_to_send() == b"JOINT NEUTRAL\n"
    assert pleo.state == "closed"
    assert pleo.say("> ", 60.0) == b""


def test_a_goodbye_does_not_break_into_an_answer(script):
    pleo = script().started()
    pleo.express("happy")
    assert pleo.run(0.005)
    pleo.driver.close()
    assert pleo.driver.bytes_to_send() == b""


def test_a_start_finds_a_prompt_into_which_the_application_talks(script):
    pleo = script()
    pleo.run(0.1)
    sent = b""
    for _ in range(8):
        sent += pleo.say("> app: drive 3 satisfied\r\n", 0.25)
    assert sent == b"APP UNLOAD\n"
