"""Whether a window can be opened, asked before anything is."""

import os
import platform

from app.errors import AppError


def has_display() -> bool:
    """Whether this computer shows a desktop to us."""
    named = os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY")
    return bool(named) or platform.system() in ("Windows", "Darwin")


def require_display() -> None:
    """Refuse, in one line, to open a window where there is no display."""
    if not has_display():
        raise AppError("there is no display here: write a video with --output FILE.mp4")
