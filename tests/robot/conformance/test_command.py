"""`cubeling robot conform`, as a person calls it."""

import json
import os
import sys

import pytest

from app import cli
from robot import SimulatedPort, Simulator
from robot.conformance import all_checks
from robot.simulators import SIMULATORS

FAST = ("wrong bit", "frames in one", "hello answered", "repeat acknowledged", "beat answered")
"""Checks that take little real time, by names."""


@pytest.fixture
def conform(monkeypatch, capsys, tmp_path):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("COLUMNS", "100")

    def run(*arguments):
        monkeypatch.setattr(sys, "argv", ["cubeling", "robot", "conform", *map(str, arguments)])
        with pytest.raises(SystemExit) as caught:
            cli.main()
        told = capsys.readouterr()
        return caught.value.code, told.out, told.err

    return run


def only(*names):
    return [part for name in names for part in ("--only", name)]


def test_a_good_robot_at_a_real_port_conforms(conform, tmp_path):
    with SimulatedPort() as port:
        code, out, err = conform(port.url, *only(*FAST), "--json", "found.json")
    assert (code, err) == (0, "")
    assert out.count("\nok ") + out.startswith("ok ") == len(FAST)
    assert f"{len(FAST)} ok" in out
    assert "It conforms." in out
    found = json.loads((tmp_path / "found.json").read_text())
    assert found["conforms"] is True
    assert {check["verdict"] for check in found["checks"]} == {"ok"}


class Forgetful(Simulator):
    def bytes_to_send(self) -> bytes:
        """Leave every ACK out."""
        frames = super().bytes_to_send().split(b"\0")
        return b"".join(b"\0" + one + b"\0" for one in frames if one and one[1:2] != b"\x90")


def test_a_robot_that_fails_is_reported_with_what_was_expected_and_received(conform, monkeypatch):
    monkeypatch.setitem(SIMULATORS, "cubeling", Forgetful)
    code, out, _ = conform("sim:cubeling", *only("command acknowledged", "frames in one"))
    assert code == 1
    assert "FAILED  command acknowledged" in out
    assert "required  EXPRESS, PLAY and STOP are each answered by ACK" in out
    assert "expected  ACK(number=1, result=0) in session" in out
    assert "received  STATE(beat=0, taken=1" in out
    assert "1 ok, 1 failed" in out
    assert "It does not conform." in out


@pytest.mark.parametrize(
    ("arguments", "told"),
    [
        ((), "a port must be named"),
        (("/dev/null",), "no serial port"),
        (("sim:nobody",), "there is no simulated robot"),
        (("sim:cubeling", "--only", "nonsense"), "no check is called 'nonsense'"),
        (("sim:cubeling", "--json", "no/such/folder/file"), "No such file"),
    ],
)
def test_invalid_options_are_reported_in_one_line(conform, arguments, told):
    code, out, err = conform(*arguments)
    assert (code, out) == (2, "")
    assert told in err
    assert err.count("\n") == 1


@pytest.mark.skipif(sys.platform == "win32", reason="there are no named pipes")
def test_a_pipe_does_not_block(conform, tmp_path):
    os.mkfifo(tmp_path / "pipe")
    code, out, err = conform("sim:cubeling", "--json", str(tmp_path / "pipe"))
    assert (code, out) == (2, "")
    assert "it is a pipe, not a file" in err


def test_the_list_names_every_check_and_what_it_requires(conform):
    code, out, _ = conform("--list")
    assert code == 0
    assert all(check.name in out for check in all_checks())


def test_every_check_has_a_section_and_a_requirement():
    for check in all_checks():
        assert 2 <= check.section <= 7
        assert check.requires.endswith(".")
    names = [check.name for check in all_checks()]
    assert len(set(names)) == len(names)
