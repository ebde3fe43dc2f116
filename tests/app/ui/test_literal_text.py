"""What robots and other players name themselves is shown as it is."""

import io
from types import SimpleNamespace

import pytest
from rich.console import Console

from cubeling.app import cli
from cubeling.app.running.summary.summary import RobotFigures, Summary
from cubeling.app.ui import roster
from cubeling.robot import LogLine
from cubeling.robot.network import Member

WILD = "[red]R\x1b[2J"
SHOWN = r"[red]R\x1b[2J"


def printed(content: object) -> str:
    out = io.StringIO()
    Console(file=out, width=200, force_terminal=False).print(content)
    return out.getvalue()


def test_the_moods_of_a_robot_in_the_summary():
    robots = {"robot": RobotFigures([(0.0, WILD)])}
    summary = Summary("companion", frames=2, duration=4.0, robots=robots)
    assert f"{SHOWN} 4.0 s" in printed(summary)


def test_what_a_robot_logged_in_the_summary():
    log = (
        LogLine(1, "information", "started", 0.0),
        LogLine(2, "warning", WILD, 1.0),
        LogLine(3, "error", "neck: 90 °C", 2.0),
    )
    robots = {"robot": RobotFigures(log=log)}
    text = printed(Summary("companion", frames=2, robots=robots))
    assert f"warning: {SHOWN}" in text
    assert "error: neck: 90 °C" in text
    assert "started" not in text
    assert "\x1b" not in text


def test_a_robot_in_the_table_of_the_network():
    state = SimpleNamespace(
        link="ready", battery=None, observed=(0.5, 0.5), label=WILD, player="", motion=WILD
    )
    entry = SimpleNamespace(messages={"state": state}, presence=lambda now: "online")
    members = SimpleNamespace(members={Member("hall", "robot", "rex"): entry})
    text = printed(roster.table(members, 0.0))  # type: ignore[arg-type] # all that it reads
    assert text.count(SHOWN) == 2
    assert "\x1b" not in text


def test_an_error_that_quotes_a_robot(capsys: pytest.CaptureFixture[str]):
    cli.print_message(f"{WILD} cannot play 'x'")
    assert capsys.readouterr().err == f"cubeling: {SHOWN} cannot play 'x'\n"
