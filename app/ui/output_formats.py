"""The kinds of files that pictures are written to; needs no FFmpeg, as names are checked by it."""

from collections.abc import Mapping
from dataclasses import dataclass, field


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

    audio_codec: str = ""
    """FFmpeg's name of the encoder of sound; "" for a kind of file without sound."""

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
    ".mp4": VideoFileFormat("mp4", "libx264", _X264, {"movflags": "faststart"}, audio_codec="aac"),
    ".mkv": VideoFileFormat("matroska", "libx264", _X264, audio_codec="libopus"),
    ".webm": VideoFileFormat("webm", "libvpx-vp9", _VP9, audio_codec="libopus"),
    # A GIF hardly compresses: at full size and rate, a second of it has several megabytes.
    ".gif": VideoFileFormat(
        "gif", "gif", {}, pixel_format="pal8", ticks_per_s=100, interval=0.1, max_width=480
    ),
}
"""The kinds of video by the suffix of the file."""

SHEET_SUFFIX = ".png"
"""Suffix of a contact sheet of frames."""

OUTPUT_SUFFIXES = (*VIDEO_FORMATS, SHEET_SUFFIX)
"""Suffixes of the files that a session can be written to."""
