"""The OpenGL context to draw with, in a window or off screen."""

import platform
from ctypes.util import find_library
from typing import Any

import moderngl

from cubeling.characters.errors import CharacterError

OPENGL_VERSION = 330
"""OpenGL 3.3 core: every driver of the last ten years has it, including Mesa's software driver."""


def create_context(window: bool = False) -> moderngl.Context:
    """Return an OpenGL context to draw with.

    Parameters
    ----------
    window
        Whether to use the context of a window that the caller has made current. Otherwise a new
        context is created that needs no display.

    Raises
    ------
    CharacterError
        There is none; the message names the missing library and how to install it.
    """
    try:
        if window:
            return moderngl.create_context(require=OPENGL_VERSION)
        # On Linux, EGL needs no display; on other systems the native backend needs none.
        settings: dict[str, Any] = {"backend": "egl"} if platform.system() == "Linux" else {}
        return moderngl.create_context(OPENGL_VERSION, standalone=True, **settings)
    except Exception as error:
        # glcontext raises exceptions of many types, each with one terse line.
        raise CharacterError(_diagnosis(window, str(error))) from error


SOFTWARE_RENDERERS = ("llvmpipe", "softpipe", "swiftshader", "microsoft basic render")
"""Parts of the names of drivers that draw on the processor, in lower case."""


def draws_in_software(context: moderngl.Context) -> bool:
    """Return whether a context draws on the processor, not on a graphics card."""
    name = str(context.info["GL_RENDERER"]).lower()
    return any(each in name for each in SOFTWARE_RENDERERS)


def _diagnosis(window: bool, reason: str) -> str:
    """Return what is missing, and the command that installs it."""
    if window:
        return (
            f"the window has no OpenGL 3.3 ({reason}): update the graphics driver, or play without "
            "a window"
        )
    if platform.system() == "Linux":
        for name, package in (("EGL", "libegl1"), ("GL", "libgl1")):
            if find_library(name) is None:
                return (
                    f"cannot draw: the library lib{name} is missing; install it with "
                    f"'sudo apt install {package} libgl1-mesa-dri'"
                )
        return (
            f"cannot draw: no driver gives OpenGL 3.3 off screen ({reason}); install Mesa's with "
            "'sudo apt install libgl1-mesa-dri'"
        )
    return f"cannot draw: no OpenGL 3.3 ({reason}); update the graphics driver"
