"""Writing pictures to a video file or an animation."""

import os
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import dataclass, field
from fractions import Fraction
from pathlib import Path
from typing import Self

import av
import av.filter
import numpy as np
from numpy.typing import NDArray

from app.errors import AppError


@dataclass(frozen=True)
class VideoFileFormat:
    """How pictures are stored in one kind of file."""

    container: str
    """FFmpeg's name of the file format."""

    codec: str
    """FFmpeg's name of the encoder."""

    options: Mapping[str, str]
    """Options of the encoder."""

    container_options: Mapping[str, str] = field(default_factory=dict)
    """Options of the file format."""

    pixel_format: str = "yuv420p"
    """FFmpeg's name of the pixels that the encoder takes."""

    ticks_per_s: int = 1000
    """Time base: timestamps are kept to the millisecond, in a GIF to 10 ms."""

    interval: float = 0.0
    """Least time between two pictures [s]; those in between are left out."""

    max_width: int = 10_000
    """Wider pictures are scaled down to this width [px]."""


# Good quality for this content; veryfast leaves processor time for rendering.
_X264 = {"preset": "veryfast", "crf": "19"}
_VP9 = {"deadline": "realtime", "cpu-used": "7", "row-mt": "1", "crf": "28", "b": "0"}

VIDEO_FORMATS = {
    ".mp4": VideoFileFormat("mp4", "libx264", _X264, {"movflags": "faststart"}),
    ".mkv": VideoFileFormat("matroska", "libx264", _X264),
    ".webm": VideoFileFormat("webm", "libvpx-vp9", _VP9),
    # A GIF hardly compresses: at full size and rate, a second of it has several megabytes.
    ".gif": VideoFileFormat(
        "gif", "gif", {}, pixel_format="pal8", ticks_per_s=100, interval=0.1, max_width=480
    ),
}
"""The kinds of video by the suffix of the file."""


class VideoFile:
    """Writes pictures to a video or an animated GIF, as the suffix says.

    Until `close` the file is called `PATH.partial`; `discard` removes it.

    Parameters
    ----------
    path
        The file; its suffix is one of `VIDEO_FORMATS`, in upper or lower case.
    size
        Width and height of the pictures [px].
    rate
        Pictures a second.

    Raises
    ------
    AppError
        The file cannot be written.
    """

    def __init__(self, path: Path, size: tuple[int, int], rate: float) -> None:
        self._path = path
        self._partial = path.with_name(path.name + ".partial")
        self._format = VIDEO_FORMATS[path.suffix.lower()]
        self._start: float | None = None
        self._next = 0.0
        self._last = -1
        try:
            self._partial.touch()
            self._file = av.open(
                str(self._partial),
                "w",
                format=self._format.container,
                options=dict(self._format.container_options),
            )
        except OSError as error:
            raise AppError(f"cannot write the video '{path}': {error.strerror}") from error
        stream = self._file.add_stream(
            self._format.codec, rate=Fraction(round(rate)), options=dict(self._format.options)
        )
        assert isinstance(stream, av.VideoStream)
        scale = min(1.0, self._format.max_width / size[0])
        stream.width, stream.height = (2 * int(scale * side / 2) for side in size)
        stream.pix_fmt = self._format.pixel_format
        # For the encoder too: in its default steps of 1/rate, frames of a live camera can coincide.
        self._time_base = Fraction(1, self._format.ticks_per_s)
        stream.time_base = stream.codec_context.time_base = self._time_base
        self._stream = stream
        self._palette: av.filter.Graph | None = None
        if stream.pix_fmt == "pal8":
            self._palette = _palette_graph(size, (stream.width, stream.height), self._time_base)
        self._open = True

    def __enter__(self) -> Self:
        return self

    def __exit__(self, kind: type[BaseException] | None, *_: object) -> None:
        if kind is None:
            self.close()
        else:
            self.discard()

    def write(self, picture: NDArray[np.uint8], timestamp: float) -> None:
        """Write one picture (H, W, 3) BGR at a time [s]."""
        if self._start is None:
            self._start = timestamp
        elapsed = timestamp - self._start
        if elapsed + 1e-6 < self._next:
            return
        self._next = max(self._next + self._format.interval, elapsed)
        self._last = max(self._last + 1, round(elapsed * self._format.ticks_per_s))
        try:
            self._file.mux(self._stream.encode(self._frame(picture)))
        except OSError as error:
            raise self._failed(error) from error

    def _frame(self, picture: NDArray[np.uint8]) -> av.VideoFrame:
        """Return a picture as the encoder takes it."""
        if self._palette is None:
            picture = picture[: self._stream.height, : self._stream.width]
        frame = av.VideoFrame.from_ndarray(np.ascontiguousarray(picture), format="bgr24")
        frame.pts, frame.time_base = self._last, self._time_base
        if self._palette is None:
            return frame
        self._palette.vpush(frame)
        return self._palette.vpull()

    def close(self) -> None:
        """Finish the file and rename it to its final name; without a picture, leave no file."""
        if not self._open:
            return
        if self._start is None:
            self.discard()
            return
        try:
            self._finish()
        except OSError as error:
            raise self._failed(error) from error
        finally:
            self.discard()

    def _finish(self) -> None:
        self._file.mux(self._stream.encode())
        self._file.close()
        os.replace(self._partial, self._path)
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


def _palette_graph(
    size: tuple[int, int], scaled: tuple[int, int], time_base: Fraction
) -> av.filter.Graph:
    """Return the filters that scale a picture and choose its 256 colours, each for itself."""
    graph = av.filter.Graph()
    source = graph.add_buffer(
        width=size[0], height=size[1], format=av.VideoFormat("bgr24"), time_base=time_base
    )
    scale = graph.add("scale", f"{scaled[0]}:{scaled[1]}:flags=area")
    split = graph.add("split")
    palette = graph.add("palettegen", "stats_mode=single")
    use = graph.add("paletteuse", "new=1:dither=bayer:bayer_scale=4")
    source.link_to(scale)
    scale.link_to(split)
    split.link_to(palette, 0, 0)
    split.link_to(use, 1, 0)
    palette.link_to(use, 0, 1)
    use.link_to(graph.add("buffersink"))
    graph.configure()
    return graph
