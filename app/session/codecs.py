"""How a session can hold pictures; an encoder is loaded when it is named."""

from collections.abc import Callable
from typing import Any

from cubeling.app.errors import AppError
from cubeling.registry import Registry

CODECS = Registry[Callable[[tuple[int, int], float], Any]](
    {
        "auto": "cubeling.app.session.frames:automatic_encoder",
        "jpeg": "cubeling.app.session.frames:jpeg_encoder",
        "h264": "cubeling.app.session.frames:H264Encoder",
    }
)
"""What makes a `FrameEncoder` for a size [px] and a rate [frames/s]."""


NO_VIDEO = "none"
"""The codec of a recording that holds all but the camera's pictures: `--no-video` names it."""


def check_codec(codec: str) -> None:
    """Raise AppError if there is no such codec."""
    if codec not in CODECS and codec != NO_VIDEO:
        known = ", ".join(CODECS)
        raise AppError(f"a session cannot hold '{codec}' pictures: choose one of {known}")
