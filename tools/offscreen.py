"""A window without a display, for pictures and benchmarks of what a window shows."""

from collections.abc import Iterator
from contextlib import contextmanager

import imgui_bundle as imgui_bundle  # isort: skip  # sets the path of the GLFW that it contains
import glfw


@contextmanager
def no_display_needed() -> Iterator[None]:
    """Let the next window need no display: EGL draws it, and nobody sees it."""
    glfw.init_hint(glfw.PLATFORM, glfw.PLATFORM_NULL)
    glfw.init()
    glfw.window_hint(glfw.CONTEXT_CREATION_API, glfw.EGL_CONTEXT_API)
    try:
        yield
    finally:
        glfw.terminate()
        glfw.init_hint(glfw.PLATFORM, glfw.ANY_PLATFORM)
