"""A session on disk: one .mcap file with the camera's frames and every message after them."""

from app.session.frames import FrameEncoder, check_codec, frame_encoder
from app.session.options import SessionOptions
from app.session.reading import (
    INSIDE_EVENT,
    START_OVER_EVENT,
    SessionInfo,
    events,
    messages,
    opening_times,
    session_info,
    spoken_lines,
    start_over_times,
)
from app.session.recorder import Recorder

__all__ = [
    "INSIDE_EVENT",
    "START_OVER_EVENT",
    "FrameEncoder",
    "Recorder",
    "SessionInfo",
    "SessionOptions",
    "check_codec",
    "events",
    "frame_encoder",
    "messages",
    "opening_times",
    "session_info",
    "spoken_lines",
    "start_over_times",
]
