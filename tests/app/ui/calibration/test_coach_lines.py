"""The coach's lines: each request once, and what is missing if it takes long."""

import io

import numpy as np
from rich.console import Console

from cubeling.app.ui.calibration.coach_lines import CoachLines
from cubeling.app.ui.calibration.session import Advice
from cubeling.tracking.calibration import ViewCoverage

PICTURE = np.zeros((2, 2, 3), np.uint8)


def said(requests, coverage=None):
    """Return what is printed for (time, request) pairs."""
    output = io.StringIO()
    lines = CoachLines(Console(file=output, width=200), "cube")
    for timestamp, request in requests:
        advice = Advice(request, False, 0, coverage or ViewCoverage(("a",)), (), ())
        lines.show_advice(PICTURE, timestamp, advice)
    return [line.split("views")[1].strip() for line in output.getvalue().splitlines()]


def test_a_request_is_printed_once_while_it_is_not_fulfilled():
    asked = [(index * 1.0, ("tilt up", "still")[index % 2]) for index in range(8)]
    assert said(asked) == ["Tip the cube up", "Good! Now hold it still"]


def test_what_is_missing_is_printed_once_if_that_takes_long():
    coverage = ViewCoverage(("a",))
    coverage.counts.update(coverage.needed)
    coverage.counts["tilt up"] = 1
    coverage.counts["near"] = 0
    asked = [(index * 0.5, "tilt up") for index in range(120)]
    assert said(asked, coverage) == [
        "Tip the cube up",
        "Still missing: tilt up 1 of 3, near 0 of 4",
    ]


def test_a_lost_cube_is_asked_for_and_then_the_request_comes_again():
    asked = [(0.0, "tilt up"), (2.0, "show"), (4.0, "tilt up")]
    assert said(asked) == ["Tip the cube up", "Show me the cube", "Tip the cube up"]
