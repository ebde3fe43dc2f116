"""A simulated robot in virtual time: the same in every run, without a wall clock."""

import pytest

from cubeling.affect import Emotion
from cubeling.robot import RobotError, SteppedRobot
from tests.examples import some

FAULTS = "sim:cubeling?drop=0.05&flip=0.001&dup=0.02&delay=20ms&stall=1s&unplug=30s&seed=7"


def lived(url: str) -> tuple[list[tuple[str, bytes, float]], SteppedRobot]:
    """Twenty seconds of a robot's life: its bytes, and itself."""
    wire: list[tuple[str, bytes, float]] = []
    robot = SteppedRobot(url, on_bytes=lambda *one: wire.append(one))
    for index in range(400):
        robot.express(Emotion(index / 400, 0.5, "happy"))
        robot.advance(0.05)
    return wire, robot


@pytest.mark.parametrize("url", some([FAULTS, "sim:pleo", "sim:opencat", "sim:cubeling?seed=3"], 3))
def test_the_same_calls_give_the_same_bytes_at_the_same_times(url):
    one, robot = lived(url)
    other, _ = lived(url)
    assert one == other
    assert len(one) > 10
    assert robot.telemetry.state in ("ready", "degraded", "lost")


def test_time_goes_on_only_when_it_is_told():
    robot = SteppedRobot("sim:cubeling")
    robot.express(Emotion(0.8, 0.5, "happy"))
    before = robot.telemetry
    assert before.acknowledged is None
    assert robot.telemetry == before
    robot.advance(0.02)
    after = robot.telemetry
    assert after.acknowledged == Emotion(0.8, 0.5, "happy")


@pytest.mark.parametrize("seconds", [-0.1, float("nan"), float("inf")])
def test_a_time_that_has_no_end_or_is_none_is_refused(seconds):
    robot = SteppedRobot("sim:cubeling")
    now = robot.now
    with pytest.raises(ValueError, match="0 s or more"):
        robot.advance(seconds)
    assert robot.now == now


def test_the_last_emotion_reaches_the_robot_despite_faults():
    _, robot = lived(FAULTS)
    robot.express(Emotion(-0.9, 0.7, "angry"))
    for _ in range(400):
        robot.advance(0.05)
        known = robot.telemetry
        if known.acknowledged == Emotion(-0.9, 0.7, "angry") and known.label == "angry":
            break
    else:
        pytest.fail("not within 20 s of virtual time")
    counts = robot.telemetry.counts
    assert counts.retries > 0
    assert counts.crc_errors > 0


def test_it_closes_as_any_robot():
    with SteppedRobot("sim:cubeling") as robot:
        pass
    assert robot.telemetry.state == "closed"
    robot.close()
    robot.advance(1.0)
    with pytest.raises(RobotError, match="was closed"):
        robot.check()


@pytest.mark.parametrize("url", ["/dev/ttyACM0", "pleo:/dev/ttyACM0", "socket://localhost:1"])
def test_a_real_port_is_refused_for_its_time_cannot_be_told(url):
    with pytest.raises(RobotError, match="no simulated robot"):
        SteppedRobot(url)
