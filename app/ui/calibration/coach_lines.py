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

Picture = NDArray[np.uint8]


class CoachLines:
    """Prints a line when the advice changes, and no more often than it can be read.

    `target` is "cube" or "board".
    """

    closed = False

    MIN_INTERVAL_S = 0.8
    """Shortest time between two lines [s]."""

    def __init__(self, console: Console, target: str) -> None:
        self._console = console
        self._target = target
        self._last = ("", -math.inf)

    def show_advice(self, picture: Picture, timestamp: float, advice: Advice) -> None:
        """Print the advice if it is new."""
        words, printed_at = self._last
        new = words_of(advice.request, self._target)
        if new == words or (
            timestamp - printed_at < self.MIN_INTERVAL_S and advice.request != "done"
        ):
            return
        self._last = new, timestamp
        share = f"{100 * advice.coverage.progress:3.0f} %  {quantity(advice.views, 'view'):>8}"
        self._console.print(f"[dim]{share}[/]  {new}", highlight=False)


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
