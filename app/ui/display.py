"""Whether this computer can open a window; needs no window library."""

import os
import platform


def has_display() -> bool:
    """Return whether there is a desktop."""
    display = os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY")
    return bool(display) or platform.system() in ("Windows", "Darwin")
