"""`cubeling robot conform`, as a person calls it."""

import json
import os
import sys
from dataclasses import replace

import pytest

from cubeling.app import cli
from cubeling.robot import SimulatedPort, Simulator
from cubeling.robot.conformance import all_checks
from cubeling.robot.conformance.checks import recorded
from cubeling.robot.simulators import SIMULATORS

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
    found = json.loads((tmp_path / "found.json").read_text())
    assert {check["verdict"] for check in found["checks"]} == {"ok"}


def test_a_few_checks_are_not_the_whole_verdict(conform, tmp_path):
    code, out, _ = conform("sim", *only("frames in one"), "--json", "found.json")
    assert code == 0
    assert f"1 ok in 0 s. Only 1 of {len(all_checks())} checks was run." in out
    assert "It passes these, which is not the whole verdict." in out
    assert "It conforms" not in out
    found = json.loads((tmp_path / "found.json").read_text())
    assert (found["conforms"], found["checks_run"]) == (None, 1)
    assert found["checks_in_all"] == len(all_checks())


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
        (("sim:cubeling", "--json", "no/such/folder/file"), "no folder 'no/such/folder'"),
        (("sim:cubeling", "--json", "."), "it is not a file"),
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
    assert "it is not a file" in err


@pytest.mark.parametrize("before", [None, "the old results"])
def test_a_failure_leaves_no_empty_results(conform, tmp_path, before):
    files = tmp_path / "found.json", tmp_path / "found.svg"
    if before is not None:
        for file in files:
            file.write_text(before)
    code, _, _ = conform("/dev/null", "--json", "found.json", "--svg", "found.svg")
    assert code == 2
    assert [file.read_text() if file.exists() else None for file in files] == [before] * 2


class Wild(Simulator):
    """Its firmware and its first joint have names that a terminal would obey."""

    def __init__(self, seed: int = 0) -> None:
        super().__init__(seed)
        joints = self.body.catalogue.joints
        wild = replace(joints[0], name="[red]\x1b[2Jx", low=joints[0].high)
        self.body.catalogue = replace(
            self.body.catalogue, firmware="[bold]\x1b[2J", joints=(wild, *joints[1:])
        )


def test_what_a_robot_sends_is_neither_markup_nor_control_codes(conform, monkeypatch):
    monkeypatch.setitem(SIMULATORS, "cubeling", Wild)
    monkeypatch.setattr(recorded, "MOVING_TIME_S", 0.1)
    monkeypatch.setattr(recorded, "MIN_MOTION_TIME_S", 0.05)
    code, out, _ = conform("sim", *only("hello answered", "joint limits sensible", "within limits"))
    assert code == 1
    assert "\x1b" not in out
    assert r"Dino ([bold]\x1b[2J), version 3" in out
    assert r"joint 0 ([red]\x1b[2Jx)" in " ".join(out.split())


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
