"""Every wait has the length that the README states."""

import re
from pathlib import Path

from cubeling import robot
from cubeling.robot.contract import port
from cubeling.robot.link import connection, exchange, transport
from cubeling.robot.protocol import timing

README = Path(robot.__file__).with_name("README.md").read_text("utf-8")
ROW = re.compile(r"^\| .* \| (\d+) ms \| `([A-Z_]+)` \|$", re.MULTILINE)


def test_the_waits_of_the_readme_are_those_of_the_code():
    rows = ROW.findall(README)
    assert len(rows) >= 9
    for milliseconds, name in rows:
        modules = (timing, connection, port, transport, exchange)
        home = next(module for module in modules if hasattr(module, name))
        assert getattr(home, name) * 1000 == int(milliseconds), name


def test_a_command_is_given_up_after_the_time_that_the_readme_names():
    assert timing.TRIES_MAX * timing.RETRY_MAX == 5.0
    assert "sent 20 times (`TRIES_MAX`), so for 5 s at most" in " ".join(README.split())
