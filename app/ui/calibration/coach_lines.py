"""The coach without a window: lines on the terminal, and a picture at the end."""

import math
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray
from rich.console import Console

from cubeling.app.counted import quantity
from cubeling.app.errors import AppError
from cubeling.app.ui.calibration.coach import draw_coverage, words_of
from cubeling.app.ui.calibration.session import Advice, CalibrationSession
from cubeling.files import write_whole
from cubeling.tracking.calibration import ViewCoverage

Picture = NDArray[np.uint8]


class CoachLines:
    """Prints what to do, once for each kind of view, and once what is missing if that takes long.

    `target` is "cube" or "board".
    """

    closed = False

    MIN_INTERVAL_S = 0.8
    """Shortest time between two lines [s]."""

    MISSING_AFTER_S = 8.0
    """Time without a line after which what is missing is printed [s]."""

    def __init__(self, console: Console, target: str) -> None:
        self._console = console
        self._target = target
        self._printed_at = -math.inf
        self._wanted = ""  # the kind of view that is asked for
        self._said: set[str] = set()  # while it is

    def show_advice(self, picture: Picture, timestamp: float, advice: Advice) -> None:
        """Print the advice if it is new, or else what is missing if it is time to."""
        coverage = advice.coverage
        wanted = coverage.next_kind()
        if wanted != self._wanted:
            self._wanted = wanted
            self._said.clear()
        words, waited = words_of(advice.request, self._target), timestamp - self._printed_at
        if words in self._said and waited >= self.MISSING_AFTER_S:
            words = f"Still missing: {_missing_views(coverage)}"
            if "missing" in self._said:
                return
            self._said.add("missing")
        if words in self._said or (waited < self.MIN_INTERVAL_S and advice.request != "done"):
            return
        if advice.request == "show":
            self._said.clear()  # when it is back, it is asked for what was missing
        self._said.add(words)
        self._printed_at = timestamp
        share = f"{100 * coverage.progress:3.0f} %  {quantity(advice.views, 'view'):>8}"
        self._console.print(f"[dim]{share}[/]  {words}", highlight=False)


def _missing_views(coverage: ViewCoverage) -> str:
    """Return the kinds of views that are missing, each with how many there are of how many."""
    return ", ".join(
        f"{kind} {coverage.counts[kind]} of {needed}"
        for kind, needed in coverage.needed.items()
        if coverage.counts[kind] < needed
    )


def write_coverage(path: Path, session: CalibrationSession) -> None:
    """Write a picture of where the target was seen: the last frame, dimmed, and all outlines.

    Raises
    ------
    AppError
        The file cannot be written.
    """
    if session.last_picture is None:
        return
    picture = np.asarray(
        cv2.addWeighted(session.last_picture, 0.45, session.last_picture, 0.0, 40), np.uint8
    )
    draw_coverage(picture, session.collector.outlines)
    good, data = cv2.imencode(path.suffix, picture)
    write_whole(path, data.tobytes() if good else b"", AppError)
