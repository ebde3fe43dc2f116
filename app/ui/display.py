"""Whether this computer can open a window, and what draws in it; needs no window library."""

import os
import platform

SOFTWARE_RENDERERS = ("llvmpipe", "softpipe", "swiftshader", "software", "gdi generic")
"""Parts of the names of drivers that render on the processor, in lower case."""


def has_display() -> bool:
    """Return whether there is a desktop."""
    display = os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY")
    return bool(display) or platform.system() in ("Windows", "Darwin")


def is_software_renderer(renderer: str) -> bool:
    """Return whether a driver with this GL_RENDERER draws without a graphics card.

    >>> is_software_renderer("llvmpipe (LLVM 15.0.7, 256 bits)")
    True
    >>> is_software_renderer("Mesa Intel(R) UHD Graphics 620 (KBL GT2)")
    False
    """
    return any(name in renderer.lower() for name in SOFTWARE_RENDERERS)
