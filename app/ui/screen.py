"""The screens that show finished pictures: none, a video file, or a window (`window`)."""

import os
from contextlib import suppress
from fractions import Fraction
from pathlib import Path
from typing import Protocol, Self

import av
import numpy as np
from numpy.typing import NDArray

from app.errors import AppError
from app.pipeline.scenario import Inputs
from app.pipeline.step import RobotView, Step
from app.ui.card_layout import CardLayout
from app.ui.notice import Notice
from app.ui.overlay import overlay
from app.ui.virtual_robot import VirtualRobot


class Screen(Protocol):
    """Shows one picture a frame. Whoever opens it closes it; a second `close` does nothing."""

    def show(self, step: Step, robot: RobotView) -> Inputs:
        """Show a step, and return the player's inputs."""

    def wait(self, notice: Notice | None) -> None:
        """Process events while no frame comes, and show a notice if there is one.

        The next `show` returns keys that are pressed in the meantime.
        """

    @property
    def closed(self) -> bool:
        """Whether the player has closed it."""

    def close(self) -> None:
        """Close it."""


class NullScreen:
    """Shows nothing: for benchmarks and for recordings without pictures."""

    closed = False

    def show(self, step: Step, robot: RobotView) -> Inputs:
        """Do nothing."""
        return Inputs()

    def wait(self, notice: Notice | None) -> None:
        """Do nothing."""

    def close(self) -> None:
        """Do nothing."""


class VideoFile:
    """Writes the pictures to an MP4 file (H.264).

    Until `close` the file is called `PATH.partial`; `discard` removes it.

    Parameters
    ----------
    path
        The file.
    size
        Width and height of the pictures [px].
    rate
        Pictures a second.
    virtual_robot
        Shown if there is no real robot; None to draw a face instead. The caller closes it.
    """

    closed = False

    def __init__(
        self,
        path: Path,
        size: tuple[int, int],
        rate: float,
        virtual_robot: VirtualRobot | None = None,
    ) -> None:
        self._path = path
        self._partial = path.with_name(path.name + ".partial")
        self._rate = rate
        self._virtual_robot = virtual_robot
        self._layout = CardLayout()
        self._start: float | None = None
        self._last = -1
        try:
            self._partial.touch()
            self._file = av.open(
                str(self._partial), "w", format="mp4", options={"movflags": "faststart"}
            )
        except OSError as error:
            raise AppError(f"cannot write the video '{path}': {error.strerror}") from error
        stream = self._file.add_stream(
            "libx264", rate=Fraction(round(rate)), options=ENCODER_OPTIONS
        )
        stream.width, stream.height = (side - side % 2 for side in size)
        stream.pix_fmt = "yuv420p"
        # For the encoder too: in its default steps of 1/rate, frames of a live camera can coincide.
        stream.time_base = stream.codec_context.time_base = Fraction(1, TICKS_PER_S)
        self._stream = stream
        self._open = True

    def __enter__(self) -> Self:
        return self

    def __exit__(self, kind: type[BaseException] | None, *_: object) -> None:
        if kind is None:
            self.close()
        else:
            self.discard()

    def show(self, step: Step, robot: RobotView) -> Inputs:
        """Write the picture of a step, with the cards over it."""
        if step.picture is not None:
            shown = overlay(step.picture, step, robot, self._virtual_robot, self._layout)
            self.write(shown, step.frame.timestamp)
        return Inputs()

    def wait(self, notice: Notice | None) -> None:
        """Write nothing: the last picture lasts until the next one."""

    def write(self, picture: NDArray[np.uint8], timestamp: float) -> None:
        """Write one picture (H, W, 3) BGR at a time [s]."""
        if self._start is None:
            self._start = timestamp
        tick = max(self._last + 1, round((timestamp - self._start) * TICKS_PER_S))
        self._last = tick
        even = picture[: self._stream.height, : self._stream.width]
        frame = av.VideoFrame.from_ndarray(np.ascontiguousarray(even), format="bgr24")
        frame.pts, frame.time_base = tick, Fraction(1, TICKS_PER_S)
        try:
            self._file.mux(self._stream.encode(frame))
        except OSError as error:
            raise self._failed(error) from error

    def close(self) -> None:
        """Finish the file and rename it to its final name."""
        if not self._open:
            return
        try:
            self._file.mux(self._stream.encode())
            self._file.close()
            os.replace(self._partial, self._path)
        except OSError as error:
            self.discard()
            raise self._failed(error) from error
        self._open = False

    def discard(self) -> None:
        """Close and delete the unfinished file."""
        if self._open:
            self._open = False
            with suppress(OSError):  # such as a full disk, the reason for discarding it
                self._file.close()
            self._partial.unlink(missing_ok=True)

    def _failed(self, error: OSError) -> AppError:
        return AppError(f"writing the video '{self._path}' failed: {error.strerror}")


ENCODER_OPTIONS = {"preset": "veryfast", "crf": "19"}
"""Good quality for this content; veryfast leaves processor time for rendering."""

TICKS_PER_S = 1000
"""Time base of the video: timestamps are kept to the millisecond."""
