"""From an open port to a board that has reported its model."""

from dataclasses import replace

import pytest

from cubeling.robot.drivers.opencat.settings import parse_settings
from cubeling.robot.simulators.opencat.simulator import OpenCatSimulator, nybble


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
