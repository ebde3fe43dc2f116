"""A session on disk: one .mcap file with the camera's frames and every arrow after them."""

from app.session.frames import Preparation, preparation
from app.session.reading import START_OVER, About, about, cues, events, messages, salvaged
from app.session.recorder import Recorder

__all__ = [
    "START_OVER",
    "About",
    "Preparation",
    "Recorder",
    "about",
    "cues",
    "events",
    "messages",
    "preparation",
    "salvaged",
]
