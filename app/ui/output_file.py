"""Writing the pictures of a session to a file; its suffix says which kind of file."""

from pathlib import Path
from typing import Protocol, Self

import cv2
import numpy as np
from numpy.typing import NDArray

from cubeling.app.pipeline.scenario import Inputs
from cubeling.app.pipeline.step import RobotView, Step
from cubeling.app.ui.canvas import PICTURE_HEIGHT
from cubeling.app.ui.cards.layout import CardLayout
from cubeling.app.ui.cards.overlay import overlay
from cubeling.app.ui.cards.virtual_robot import VirtualRobot
from cubeling.app.ui.contact_sheets import frame_sheet, save
from cubeling.app.ui.output_formats import AUTO_CODEC, SHEET_SUFFIX
from cubeling.app.ui.playback.cards import draw_ending
from cubeling.app.ui.playback.status import SessionStatus
from cubeling.app.ui.screen import NullScreen
from cubeling.app.ui.video_file import AudioSource, VideoFile

ENDING_S, ENDING_RATE = 3.0, 10.0
"""How long the card at the end of a video is shown [s], and its pictures a second."""


class PictureWriter(Protocol):
    """Writes pictures to one file, which appears when it is complete."""

    def write(self, picture: NDArray[np.uint8], timestamp: float) -> None:
        """Write one picture (H, W, 3) BGR at a time [s]."""

    def close(self) -> None:
        """Complete the file; a second call does nothing."""

    def discard(self) -> None:
        """Leave no file; does nothing after `close`."""


class OutputFile(NullScreen):
    """A `Screen` that writes its pictures to a file, with the cards over them.

    Leaving it as a context manager completes the file; leaving it with an error leaves no file.

    Parameters
    ----------
    path
        The file; its suffix is one of `OUTPUT_SUFFIXES`, in upper or lower case.
    size
        Width and height of the pictures [px].
    rate
        Pictures a second.
    virtual_robot
        Shown if there is no real robot; None to draw a face instead. The caller closes it.
    sound
        What is heard in a video, as `VideoFile` takes it; None for a silent one.
    codec
        What encodes the pictures of a video, as `VideoFile` takes it.
    start_s
        Where in its recording the first picture is, for the captions of a sheet [s].

    Raises
    ------
    AppError
        The file cannot be written.
    """

    def __init__(
        self,
        path: Path,
        size: tuple[int, int],
        rate: float,
        virtual_robot: VirtualRobot | None = None,
        sound: AudioSource | None = None,
        codec: str = AUTO_CODEC,
        start_s: float = 0.0,
    ) -> None:
        self._virtual_robot = virtual_robot
        self._layout = CardLayout()
        self._last: tuple[NDArray[np.uint8], float] | None = None
        self._moving = path.suffix.lower() != SHEET_SUFFIX
        self._writer: PictureWriter
        if self._moving:
            self._writer = VideoFile(path, size, rate, sound, codec)
        else:
            self._writer = FrameSheet(path, start_s)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, kind: type[BaseException] | None, *_: object) -> None:
        if kind is None:
            self.close()
        else:
            self._writer.discard()

    def show(self, step: Step, robot: RobotView) -> Inputs:
        """Write the picture of a step."""
        if step.picture is not None:
            picture = overlay(step.picture, step, robot, self._virtual_robot, self._layout)
            self._writer.write(picture, step.frame.timestamp)
            self._last = picture, step.frame.timestamp
        return Inputs()

    def report(self, status: SessionStatus) -> None:
        """Write the card at the end of a recording over its last picture, for some seconds."""
        if status.ending is None or self._last is None or not self._moving:
            return
        picture, timestamp = self._last
        self._last = None
        scale = picture.shape[0] / PICTURE_HEIGHT
        card = draw_ending(status.ending, "", picture.shape[1] / scale, scale)
        card.blend_over(picture)
        for number in range(1, round(ENDING_S * ENDING_RATE) + 1):
            self._writer.write(picture, timestamp + number / ENDING_RATE)

    def close(self) -> None:
        """Complete the file; without it, it may not open."""
        self._writer.close()


MAX_FRAMES = 24
"""Pictures on a sheet."""

FRAME_WIDTH_PX = 400
"""Width of each picture [px]."""


class FrameSheet:
    """Writes a .png file with at most `MAX_FRAMES` pictures of a session of any length.

    It keeps a picture at even intervals. Whenever it has too many, it leaves out every second one
    and doubles the interval, so the length need not be known. The caption of the first one is
    `start_s`: where a part of a recording begins [s].
    """

    def __init__(self, path: Path, start_s: float = 0.0) -> None:
        self._path, self._start_s = path, start_s
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
            first = self._kept[0][0] - self._start_s
            frames = [(f"{time - first:.1f} s", picture) for time, picture in picks]
            save(frame_sheet(self._path.stem, frames), self._path)

    def discard(self) -> None:
        """Forget the pictures: `close` then writes nothing."""
        self._open = False
