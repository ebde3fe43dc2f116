"""Whether this computer can open a window; needs no window library."""

import os
import platform

from app.errors import AppError


def has_display() -> bool:
    """Return whether there is a desktop."""
    display = os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY")
    return bool(display) or platform.system() in ("Windows", "Darwin")


def require_display() -> None:
    """Raise an error if there is no display.

    Raises
    ------
    AppError
        There is no display.
    """
    if not has_display():
        raise AppError("there is no display here: write a video with --output FILE.mp4")
