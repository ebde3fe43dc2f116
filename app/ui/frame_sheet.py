"""A contact sheet of a session: pictures at even intervals, on one page."""

from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray

from cubeling.app.ui.contact_sheets import frame_sheet, save

MAX_FRAMES = 24
"""Pictures on a sheet."""

FRAME_WIDTH_PX = 400
"""Width of each picture [px]."""


class FrameSheet:
    """Writes a .png file with at most `MAX_FRAMES` pictures of a session of any length.

    It keeps a picture at even intervals. Whenever it has too many, it leaves out every second one
    and doubles the interval, so the length need not be known.
    """

    def __init__(self, path: Path) -> None:
        self._path = path
        self._kept: list[tuple[float, NDArray[np.uint8]]] = []
        self._interval = 0.0
        self._open = True

    def write(self, picture: NDArray[np.uint8], timestamp: float) -> None:
        """Keep a small copy of a picture (H, W, 3) BGR if it is due at this time [s]."""
        if self._kept and timestamp - self._kept[-1][0] < self._interval:
            return
        height = round(picture.shape[0] * FRAME_WIDTH_PX / picture.shape[1])
        small = cv2.resize(picture, (FRAME_WIDTH_PX, height), interpolation=cv2.INTER_AREA)
        self._kept.append((timestamp, np.asarray(small, np.uint8)))
        if len(self._kept) > 4 * MAX_FRAMES:
            self._kept = self._kept[::2]
            self._interval = (self._kept[-1][0] - self._kept[0][0]) / (len(self._kept) - 1)

    def close(self) -> None:
        """Write the sheet; without a picture, write none. A second call does nothing."""
        if not self._open:
            return
        self._open = False
        if self._kept:
            last = len(self._kept) - 1
            count = min(MAX_FRAMES, len(self._kept))
            picks = [self._kept[round(at)] for at in np.linspace(0, last, count)]
            start = self._kept[0][0]
            frames = [(f"{time - start:.1f} s", picture) for time, picture in picks]
            save(frame_sheet(self._path.stem, frames), self._path)

    def discard(self) -> None:
        """Forget the pictures: `close` then writes nothing."""
        self._open = False
