"""Pleo by `cubeling.robot.connect`: without a port, and over a real pseudo-terminal."""

import re
import sys
import time
from pathlib import Path

import pytest

from cubeling import robot
from cubeling.robot.drivers import DRIVERS
from cubeling.robot.drivers.pleo import timing
from cubeling.robot.errors import RobotError
from cubeling.robot.simulators.pleo.simulator import PleoSimulator


def fast() -> float:
    """Give a clock that runs eight times as fast, since a start takes two seconds or more."""
    return 8 * time.monotonic()


HAPPY = robot.Emotion(0.8, 0.5)
DOCUMENT = Path(__file__).parents[4] / "docs" / "pleo.md"


def all_answered(counts: robot.LinkCounts) -> bool:
    return counts.frames_sent == counts.frames_received


def test_a_simulated_pleo_is_found_by_its_name(soon):
    with robot.connect("sim:pleo?seed=5", clock=fast) as pleo:
        assert pleo.telemetry.state == "ready"
        assert pleo.catalogue.name == "Pleo"
        assert len(pleo.catalogue.joints) == 14
        pleo.express(HAPPY)
        soon(lambda: pleo.telemetry.acknowledged == HAPPY)
        soon(lambda: pleo.telemetry.battery is not None)


@pytest.mark.skipif(sys.platform == "win32", reason="there are no pseudo-terminals")
def test_a_mood_reaches_pleo_over_a_real_port_and_the_goodbye_is_neutral(soon):
    simulator = PleoSimulator(5)
    simulator.slow_probability = simulator.error_probability = 0.0
    with robot.SimulatedPort(simulator, clock=fast) as port:
        with robot.connect(f"pleo:{port.url}", clock=fast) as pleo:
            pleo.express(HAPPY)
            soon(lambda: simulator.portrait()[1] == "happy")
            soon(lambda: pleo.telemetry.acknowledged == HAPPY)
            soon(lambda: all_answered(pleo.telemetry.counts))
        soon(lambda: simulator.executed[-1] == "JOINT NEUTRAL")
        assert not simulator.violations


def test_settings_that_are_wrong_open_nothing(tmp_path):
    (tmp_path / "mine.toml").write_text("[moods.happy]\njoints = {}\n")
    with pytest.raises(RobotError, match="mood called neutral"):
        robot.connect("sim:pleo", settings=tmp_path / "mine.toml")


def test_the_document_states_the_times_that_are_used():
    said = dict(re.findall(r"`([A-Z_]+)` \| ([\d.]+)", DOCUMENT.read_text()))
    assert len(said) >= 9
    for name, value in said.items():
        assert float(value) == getattr(timing, name), name
    assert DRIVERS["pleo"].answer_within == timing.ANSWER_TIMEOUT_S
    assert DRIVERS["pleo"].baud == 115200


def test_the_settings_in_the_document_are_right(tmp_path):
    (example,) = re.findall(r"```toml\n(.*?)```", DOCUMENT.read_text(), re.DOTALL)
    (tmp_path / "example.toml").write_text(example)
    from cubeling.robot.drivers.pleo.settings import load_settings

    mine = load_settings(tmp_path / "example.toml")
    assert mine.moods["angry"].joints == {8: -10, 10: 45}
