"""`cubeling robot simulate`: any robot with any faults; a wrong option is one line."""

import pytest

from cubeling.robot.simulators import SIMULATORS
from cubeling.robot.simulators.faults import OPTIONS


@pytest.mark.parametrize("name", [*SIMULATORS, "sim:cubeling?drop=0.05&stall=1s", "pleo?seed=3"])
def test_every_robot_can_be_put_behind_a_port(cubeling, name):
    code, out, err = cubeling("robot", "simulate", name, "--seconds", "0.05")
    assert (code, err) == (0, "")
    assert "A robot listens on " in out


def test_the_printed_url_names_the_protocol(cubeling):
    _, out, _ = cubeling("robot", "simulate", "pleo?babble=10", "--seconds", "0.05")
    assert "--robot pleo:" in out


@pytest.mark.parametrize(
    ("arguments", "named"),
    [
        (["cat"], "there is no simulated robot 'cat'; there is sim:cubeling"),
        (["cubeling?drop=2"], "drop must be a probability from 0 to 1, not '2'"),
        (["cubeling?fly=1"], "'fly' is no option of a simulator; there are seed, drop"),
        (["cubeling?seed=1", "--seed", "2"], "seed is given twice"),
        (["--seconds", "nan"], "0 seconds or more, not for nan"),
        (["--seconds", "-1"], "0 seconds or more, not for -1"),
    ],
)
def test_wrong_options_are_refused_in_one_line(cubeling, arguments, named):
    code, out, err = cubeling("robot", "simulate", *arguments)
    assert (code, out) == (2, "")
    assert named in err
    assert err.count("\n") == 1


def test_the_help_explains_every_fault(cubeling):
    _, out, _ = cubeling("robot", "simulate", "--help")
    for option in (*OPTIONS, "seed"):
        assert f"{option}=" in out
