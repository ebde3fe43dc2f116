"""A session on disk: one .mcap file with the camera's frames and every message after them."""

from cubeling.app.session.frames import FrameEncoder, check_codec, frame_encoder
from cubeling.app.session.options import SessionOptions
from cubeling.app.session.reading import (
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
from cubeling.app.session.recorder import Recorder

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
