"""Dear ImGui in a window of GLFW."""

import ctypes
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

# imgui-bundle contains the GLFW library that both must share, and sets its path on import.
from imgui_bundle import imgui  # isort: skip
import glfw

from cubeling.app.ui.canvas import PICTURE_HEIGHT

MIN_CARD_SHARE = 0.7
"""Size of a design unit on a panel next to that on a card, at least."""


class ImGuiBackend:
    """Gives Dear ImGui the events of a window; made after its own callbacks, closed before it.

    `window` is GLFW's, and its OpenGL context is current.
    """

    def __init__(self, window: Any) -> None:
        imgui.create_context()  # it chains to the callbacks that are already set
        imgui.get_io().set_ini_filename("")
        address = ctypes.cast(window, ctypes.c_void_p).value
        assert address is not None, "the window is open"
        imgui.backends.glfw_init_for_opengl(address, True)
        imgui.backends.opengl3_init("#version 330")

    @contextmanager
    def frame(self) -> Iterator[None]:
        """Take what is drawn with Dear ImGui meanwhile; `render` draws it."""
        imgui.backends.opengl3_new_frame()
        imgui.backends.glfw_new_frame()
        imgui.new_frame()
        try:
            yield
        finally:
            imgui.render()

    def render(self) -> None:
        """Draw the last frame into the framebuffer that is in use."""
        imgui.backends.opengl3_render_draw_data(imgui.get_draw_data())

    def close(self) -> None:
        """Release what Dear ImGui needs."""
        imgui.backends.opengl3_shutdown()
        imgui.backends.glfw_shutdown()
        imgui.destroy_context()


def ui_scale(window: Any) -> float:
    """Return how many of the window's coordinates a design unit has.

    It is what the system asks for: 1 where it counts in larger points than pixels, as on macOS. A
    large window has more, so that who stands before it can read the panels too.
    """
    scale, _ = glfw.get_window_content_scale(window)
    pixels, _ = glfw.get_framebuffer_size(window)
    points, height = glfw.get_window_size(window)
    system = float(scale * points / pixels) if pixels and points else 1.0
    return max(system, MIN_CARD_SHARE * height / PICTURE_HEIGHT)
