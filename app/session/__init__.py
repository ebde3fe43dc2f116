"""A session on disk: one .mcap file with the camera's frames and every arrow after them."""

from app.session.pictures import Preparation, preparation
from app.session.reading import About, about, events, messages, salvaged
from app.session.recorder import Recorder

__all__ = [
    "About",
    "Preparation",
    "Recorder",
    "about",
    "events",
    "messages",
    "preparation",
    "salvaged",
]
