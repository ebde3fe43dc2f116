"""The coach where there is no window: lines on the terminal, and a picture at the end."""

import math
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray
from rich.console import Console

from app.errors import AppError
from app.ui.calibration.coach import cover, words_of
from app.ui.calibration.session import Advice, CalibrationSession

Picture = NDArray[np.uint8]

FORMATS = (".png", ".jpg")
"""What a picture of the coverage can be."""


class CoachLines:
    """Prints a line when the advice changes, and no more often than it can be read.

    Parameters
    ----------
    console
        Where to print.
    target
        "cube" or "board".
    """

    closed = False

    PATIENCE = 0.8
    """A line stays for so long before the next [s]."""

    def __init__(self, console: Console, target: str) -> None:
        self._console = console
        self._target = target
        self._told = ("", -math.inf)

    def show_advice(self, picture: Picture, timestamp: float, advice: Advice) -> None:
        """Print what to do if it is something new."""
        words, at = self._told
        new = words_of(advice.wish, self._target)
        if new == words or (timestamp - at < self.PATIENCE and advice.wish != "done"):
            return
        self._told = new, timestamp
        share = f"{100 * advice.coverage.progress:3.0f} %  {advice.views:2d} views"
        self._console.print(f"[dim]{share}[/]  {new}", highlight=False)


def write_coverage(path: Path, session: CalibrationSession) -> None:
    """Write a picture of where the target was seen: the last frame, dimmed, and all outlines.

    Raises
    ------
    AppError
        It cannot be written there.
    """
    if session.last is None:
        return
    picture = np.asarray(cv2.addWeighted(session.last, 0.45, session.last, 0.0, 40), np.uint8)
    cover(picture, session.collector.outlines)
    good, data = cv2.imencode(path.suffix, picture)
    try:
        path.write_bytes(data.tobytes() if good else b"")
    except OSError as error:
        raise AppError(f"cannot write the picture '{path}': {error.strerror}") from error
