"""Draws the picture in docs/conformance.md: `python -m tests.robot.conformance.picture`."""

import contextlib
from pathlib import Path

import typer

from cubeling.app.commands.robots.robot.conform import conform
from cubeling.robot import SimulatedPort
from tests.robot.conformance.mutants.commands import AcknowledgesOnce
from tests.robot.conformance.mutants.sessions import SaysGoneToEverything

PICTURE = Path(__file__).parents[3] / "docs" / "pictures" / "conform.svg"

SHOWN = ["wrong", "hello", "gone", "version", "acknowledged", "round trip", "bye"]
"""Words in the names of the checks that are in the picture."""


class Hasty(AcknowledgesOnce, SaysGoneToEverything):
    """A robot with two mistakes that are often made."""


if __name__ == "__main__":
    with SimulatedPort(Hasty()) as port, contextlib.suppress(typer.Exit):
        conform(port.url, SHOWN, picture=PICTURE)
