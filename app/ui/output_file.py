"""Writing the pictures of a session to a file; its suffix says which kind of file."""

from pathlib import Path
from typing import Protocol, Self

import numpy as np
from numpy.typing import NDArray

from app.pipeline.scenario import Inputs
from app.pipeline.step import RobotView, Step
from app.ui.card_layout import CardLayout
from app.ui.frame_sheet import FrameSheet
from app.ui.notice import Notice
from app.ui.overlay import overlay
from app.ui.video_file import VIDEO_FORMATS, AudioSource, VideoFile
from app.ui.virtual_robot import VirtualRobot

SHEET_SUFFIX = ".png"
"""Suffix of a contact sheet of frames."""

OUTPUT_SUFFIXES = (*VIDEO_FORMATS, SHEET_SUFFIX)
"""Suffixes of the files that a session can be written to."""


class PictureWriter(Protocol):
    """Writes pictures to one file, which appears when it is complete."""

    def write(self, picture: NDArray[np.uint8], timestamp: float) -> None:
        """Write one picture (H, W, 3) BGR at a time [s]."""

    def close(self) -> None:
        """Complete the file; a second call does nothing."""

    def discard(self) -> None:
        """Leave no file; does nothing after `close`."""


class OutputFile:
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

    closed = False

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
        self._writer: PictureWriter
        if path.suffix.lower() == SHEET_SUFFIX:
            self._writer = FrameSheet(path)
        else:
            self._writer = VideoFile(path, size, rate, sound)

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
        return Inputs()

    def wait(self, notice: Notice | None) -> None:
        """Write nothing: the last picture lasts until the next one."""

    def close(self) -> None:
        """Complete the file."""
        self._writer.close()
