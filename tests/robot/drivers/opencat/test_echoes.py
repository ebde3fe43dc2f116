"""Which echo confirms which command, and which emotion is acknowledged by it."""

from cubeling.affect import Emotion
from cubeling.robot.drivers.opencat.echo import QUESTION_TIMEOUT_S
from cubeling.robot.drivers.opencat.host import OpenCatHost
from tests.robot.drivers.opencat.boards import HeldBackBoard, introduced_host

HAPPY = Emotion(0.7, 0.6, "happy")


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


def test_a_fall_clears_what_is_acknowledged():
    host = introduced_host()
    host.express(HAPPY)
    host.tick(3.0)
    host.bytes_to_send()
    host.receive(b"k\r\n", 3.5)
    assert host.telemetry(3.5).acknowledged == HAPPY
    host.receive(b"EXCEPTION: Fall over\r\n", 3.6)
    known = host.telemetry(3.6)
    assert (known.acknowledged, known.complaint) == (None, "EXCEPTION: Fall over")


def test_a_late_echo_counts_for_its_own_command_and_for_no_later_one(desk, quiet):
    robot = HeldBackBoard(4, quirks=quiet)
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


def test_the_k_of_a_starting_board_is_no_echo(desk):
    d = desk().ready()
    d.feel("happy")
    d.until(lambda: "kbuttUp" in d.lines, 5.0)
    d.robot.reboot()  # a brown-out, as the servos begin to move
    d.run(1.5)
    assert d.telemetry.acknowledged is None
    d.settle()
    assert d.lines.count("kbuttUp") == 2


def test_a_question_asked_before_a_fall_does_not_end_the_doubt():
    host = introduced_host()
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
    host = introduced_host()
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
    host = introduced_host()
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
