"""What may stand in a simulator's URL, and what is said of anything else."""

import re
from pathlib import Path

import pytest

from cubeling.robot.errors import RobotError
from cubeling.robot.simulators.cubeling.simulator import Simulator
from cubeling.robot.simulators.faults import OPTIONS, Faults, Outage, faults_of
from cubeling.robot.simulators.faulty import FaultyRobot
from cubeling.robot.simulators.memory import simulator_of


def test_every_option_is_read_in_its_unit():
    options = {
        "drop": "0.05", "flip": ".001", "dup": "0", "split": "1", "babble": "200",
        "delay": "20ms~5ms", "stall": "1s/10s", "unplug": "30s/500ms", "reboot": "60s",
    }  # fmt: skip
    assert faults_of("sim:cubeling", options) == Faults(
        drop=0.05, flip=0.001, dup=0.0, split=1.0, babble=200.0, delay=0.02, jitter=0.005,
        stall=Outage(1.0, 10.0), unplug=Outage(0.5, 30.0), reboot=60.0,
    )  # fmt: skip
    assert set(options) == set(OPTIONS)


def test_what_is_not_said_has_its_default():
    faults = faults_of("sim:cubeling", {"stall": "1s", "unplug": "30s", "delay": "5ms"})
    assert faults == Faults(delay=0.005, stall=Outage(1.0, 20.0), unplug=Outage(1.0, 30.0))


@pytest.mark.parametrize(
    "query",
    [
        "drop=2", "drop=-0.1", "drop=", "drop=5%25", "flip=nan", "dup=inf", "split=x", "babble=-1",
        "babble=1e9", "delay=20", "delay=20m", "delay=11s", "delay=5ms~6ms", "delay=5ms~",
        "stall=0s", "stall=1s/", "stall=/5s", "unplug=1ms", "unplug=30s/2", "reboot=soon",
        "reboot=0s",
    ],
)  # fmt: skip
def test_a_wrong_value_is_refused_in_one_line_that_says_what_is_allowed(query):
    name, _, _ = query.partition("=")
    with pytest.raises(RobotError) as refused:
        simulator_of(f"sim:cubeling?{query}")
    text = str(refused.value)
    assert "\n" not in text
    assert f"{name} must be {OPTIONS[name][1]}" in text


def test_an_unknown_option_is_refused_with_those_there_are():
    with pytest.raises(RobotError, match="'fly' is no option of a simulator; there are seed, drop"):
        simulator_of("sim:cubeling?fly=1")


def test_an_option_that_is_given_twice_is_refused():
    with pytest.raises(RobotError, match="drop is given twice"):
        simulator_of("sim:cubeling?drop=0.1&drop=0.2")


def test_without_faults_there_is_nothing_between_the_robot_and_its_port():
    assert isinstance(simulator_of("sim:cubeling?seed=3"), Simulator)
    assert isinstance(simulator_of("cubeling?drop=0"), Simulator)
    assert isinstance(simulator_of("cubeling?drop=0.1"), FaultyRobot)


def test_the_document_explains_every_option():
    text = (Path(__file__).parents[3] / "docs" / "faults.md").read_text("utf-8")
    for option in (*OPTIONS, "seed"):
        assert re.search(rf"^\| `{option}=", text, re.MULTILINE), f"{option} is not explained"
