"""Writing the pictures of a session to a file; its suffix says which kind of file."""

from pathlib import Path
from typing import Protocol, Self

import numpy as np
from numpy.typing import NDArray

from cubeling.app.pipeline.scenario import Inputs
from cubeling.app.pipeline.step import RobotView, Step
from cubeling.app.ui.canvas import PICTURE_HEIGHT
from cubeling.app.ui.cards.layout import CardLayout
from cubeling.app.ui.cards.overlay import overlay
from cubeling.app.ui.cards.virtual_robot import VirtualRobot
from cubeling.app.ui.frame_sheet import FrameSheet
from cubeling.app.ui.output_formats import SHEET_SUFFIX
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
    ) -> None:
        self._virtual_robot = virtual_robot
        self._layout = CardLayout()
        self._last: tuple[NDArray[np.uint8], float] | None = None
        self._moving = path.suffix.lower() != SHEET_SUFFIX
        self._writer: PictureWriter
        self._writer = VideoFile(path, size, rate, sound) if self._moving else FrameSheet(path)

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
