"""The kinds of files that pictures are written to; needs no FFmpeg, as names are checked by it."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

from cubeling.app.errors import AppError

AUTO_CODEC = "auto"
"""Stands for the first encoder of a kind of video that FFmpeg has."""

# Each gives about the same quality for this content, and leaves processor time for rendering.
ENCODERS: Mapping[str, Mapping[str, str]] = {
    "libx264": {"preset": "veryfast", "crf": "19"},
    "libx265": {"preset": "veryfast", "crf": "22", "x265-params": "log-level=error"},
    "libsvtav1": {"preset": "9", "crf": "28"},
    "libvpx-vp9": {"deadline": "realtime", "cpu-used": "7", "row-mt": "1", "crf": "28", "b": "0"},
    "libvpx": {"deadline": "realtime", "cpu-used": "7", "crf": "8", "b": "8M"},
    "mpeg4": {"flags": "+qscale", "global_quality": "354"},  # quantizer 3, times FF_QP2LAMBDA
    "gif": {},
}
"""The encoders of pictures by FFmpeg's names, with their options. Two are GPL: docs/licences.md."""


@dataclass(frozen=True)
class VideoFileFormat:
    """How pictures are stored in one kind of file."""

    container: str
    """FFmpeg's name of the file format."""

    encoders: tuple[str, ...]
    """Those of `ENCODERS` whose pictures it takes; the usual one first."""

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


_MP4_ENCODERS = ("libx264", "libx265", "libsvtav1", "libvpx-vp9", "mpeg4")

VIDEO_FORMATS = {
    ".mp4": VideoFileFormat("mp4", _MP4_ENCODERS, {"movflags": "faststart"}, audio_codec="aac"),
    ".mkv": VideoFileFormat("matroska", (*_MP4_ENCODERS, "libvpx"), audio_codec="libopus"),
    ".webm": VideoFileFormat("webm", ("libvpx-vp9", "libsvtav1", "libvpx"), audio_codec="libopus"),
    # A GIF hardly compresses: at full size and rate, a second of it has several megabytes.
    ".gif": VideoFileFormat(
        "gif", ("gif",), pixel_format="pal8", ticks_per_s=100, interval=0.1, max_width=480
    ),
}
"""The kinds of video by the suffix of the file."""

SHEET_SUFFIX = ".png"
"""Suffix of a contact sheet of frames."""

OUTPUT_SUFFIXES = (*VIDEO_FORMATS, SHEET_SUFFIX)
"""Suffixes of the files that a session can be written to."""


def check_video_codec(path: Path, codec: str) -> None:
    """Raise AppError if a file cannot hold the pictures of an encoder; "auto" fits every file."""
    if codec == AUTO_CODEC:
        return
    suffix = path.suffix.lower()
    if suffix not in VIDEO_FORMATS:
        raise AppError(f"{path.name} is no video: leave out --codec")
    known = VIDEO_FORMATS[suffix].encoders
    if codec not in known:
        raise AppError(
            f"a {suffix} video cannot hold '{codec}' pictures: choose one of {', '.join(known)}"
        )
