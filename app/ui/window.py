"""The live window: the picture, scaled to fit, and a panel with details."""

import contextlib
import ctypes
import time
from collections import deque
from typing import Any, Self

# imgui-bundle contains the GLFW library that both must share, and sets its path on import.
from imgui_bundle import imgui  # isort: skip
import glfw
import moderngl
import numpy as np
from numpy.typing import NDArray

from app.errors import AppError
from app.pipeline.registry import SCENARIOS
from app.pipeline.scenario import Inputs
from app.pipeline.step import RobotView, Step
from app.ui.card_layout import CardLayout
from app.ui.notice import Notice
from app.ui.overlay import interrupted, overlay, virtual_robot_side
from app.ui.virtual_robot import VirtualRobot
from characters.rendering import create_context

VERTEX_SHADER = """
#version 330
out vec2 place;
void main() {
    vec2 corner = vec2(gl_VertexID & 1, gl_VertexID >> 1);
    place = vec2(corner.x, 1.0 - corner.y);
    gl_Position = vec4(corner * 2.0 - 1.0, 0.0, 1.0);
}
"""

FRAGMENT_SHADER = """
#version 330
uniform sampler2D picture;
in vec2 place;
out vec4 color;
void main() { color = vec4(texture(picture, place).bgr, 1.0); }
"""

KEY_HELP = "Esc  quit      F  full screen      C  start over      H  this panel      "
SCENARIO_KEYS = {glfw.KEY_1 + place: name for place, name in enumerate(SCENARIOS)}
KEY_HELP += "   ".join(f"{place}  {name}" for place, name in enumerate(SCENARIOS, start=1))


class Window:
    """A `Screen` on the desktop. Whoever opens it closes it; a second `close` does nothing.

    Parameters
    ----------
    size
        Width and height of the pictures [px].
    title
        Text of the title bar.

    Raises
    ------
    AppError
        There is no display, or its driver offers no OpenGL 3.3.
    """

    def __init__(self, size: tuple[int, int], title: str = "Cubeling") -> None:
        self._size = size
        self._error = ""
        glfw.set_error_callback(self._store_error)
        if not glfw.init():
            raise AppError(f"no window can be opened here: {self._error or 'there is no display'}")
        for hint, value in (
            (glfw.CONTEXT_VERSION_MAJOR, 3),
            (glfw.CONTEXT_VERSION_MINOR, 3),
            (glfw.OPENGL_PROFILE, glfw.OPENGL_CORE_PROFILE),
            (glfw.OPENGL_FORWARD_COMPAT, True),
        ):
            glfw.window_hint(hint, value)
        self._window = glfw.create_window(*_fitting(size), title, None, None)
        if not self._window:
            glfw.terminate()
            raise AppError(f"no window can be opened here: {self._error}")
        glfw.make_context_current(self._window)
        glfw.swap_interval(0)  # a camera's frame must not wait for the screen's
        self.context = create_context(window=True)
        """Where a `Stage` for this window draws."""
        self._virtual_robot = VirtualRobot(self.context, virtual_robot_side(size[1]))
        self._layout = CardLayout()
        self._start_panel()
        self._texture = self.context.texture(size, 3, alignment=1)
        self._program = self.context.program(
            vertex_shader=VERTEX_SHADER, fragment_shader=FRAGMENT_SHADER
        )
        self._quad = self.context.vertex_array(self._program, [])
        self._shown_at: deque[float] = deque(maxlen=60)
        self._panel = False
        self._clear = False
        self._scenario = ""
        self._last: NDArray[np.uint8] | None = None
        self._open = True

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    @property
    def closed(self) -> bool:
        """Whether the player has closed the window."""
        return not self._open or bool(glfw.window_should_close(self._window))

    def show(self, step: Step, robot: RobotView) -> Inputs:
        """Show a step, and return the keys that the player pressed."""
        if self.closed:
            return Inputs()
        if step.picture is not None:
            self._last = overlay(step.picture, step, robot, self._virtual_robot, self._layout)
            self.paint(self._last)
        self._shown_at.append(time.perf_counter())
        self._draw_panel(step, robot)
        glfw.swap_buffers(self._window)
        glfw.poll_events()
        clear, self._clear = self._clear, False
        scenario, self._scenario = self._scenario, ""
        return Inputs(clear=clear, scenario=scenario)

    def wait(self, notice: Notice | None) -> None:
        """Process events; show a notice over the last picture."""
        if self.closed:
            return
        if notice is not None and self._last is not None:
            self.paint(interrupted(self._last, notice))
            glfw.swap_buffers(self._window)
        glfw.poll_events()

    def close(self) -> None:
        """Close the window and release its context."""
        if not self._open:
            return
        self._open = False
        imgui.backends.opengl3_shutdown()
        imgui.backends.glfw_shutdown()
        imgui.destroy_context()
        self._virtual_robot.close()
        for thing in (self._quad, self._program, self._texture):
            thing.release()
        self.context.release()
        glfw.destroy_window(self._window)
        glfw.terminate()

    def paint(self, picture: NDArray[np.uint8]) -> None:
        """Draw a picture into the back buffer, as large as it fits."""
        self._texture.write(np.ascontiguousarray(picture))
        screen = self.context.detect_framebuffer(0)
        screen.use()
        wide, high = glfw.get_framebuffer_size(self._window)
        screen.viewport = (0, 0, wide, high)
        screen.clear(0.09, 0.10, 0.13)
        scale = min(wide / self._size[0], high / self._size[1])
        shown = (round(self._size[0] * scale), round(self._size[1] * scale))
        screen.viewport = ((wide - shown[0]) // 2, (high - shown[1]) // 2, *shown)
        self.context.disable(moderngl.DEPTH_TEST | moderngl.BLEND | moderngl.CULL_FACE)
        self._texture.use(0)
        self._quad.render(moderngl.TRIANGLE_STRIP, 4)
        screen.viewport = (0, 0, wide, high)

    def _start_panel(self) -> None:
        # Our callbacks first: imgui chains to those that are already set.
        glfw.set_key_callback(self._window, self._on_key)
        imgui.create_context()
        imgui.get_io().set_ini_filename("")
        address = ctypes.cast(self._window, ctypes.c_void_p).value
        assert address is not None, "the window was opened above"
        imgui.backends.glfw_init_for_opengl(address, True)
        imgui.backends.opengl3_init("#version 330")

    def _draw_panel(self, step: Step, robot: RobotView) -> None:
        imgui.backends.opengl3_new_frame()
        imgui.backends.glfw_new_frame()
        imgui.new_frame()
        if self._panel:
            self._panel_text(step, robot)
        imgui.render()
        imgui.backends.opengl3_render_draw_data(imgui.get_draw_data())

    def _panel_text(self, step: Step, robot: RobotView) -> None:
        imgui.set_next_window_pos((24.0, 90.0), imgui.Cond_.first_use_ever)
        imgui.begin("Details", None, imgui.WindowFlags_.always_auto_resize)
        span = self._shown_at[-1] - self._shown_at[0]
        rate = (len(self._shown_at) - 1) / span if span > 0 else 0.0
        state, controls = step.state, step.controls
        imgui.text(
            f"{rate:5.1f} pictures/s   {step.frame.image.shape[1]} x {step.frame.image.shape[0]}"
        )
        seen = ", ".join(state.faces) if state.visible else state.refused or "not seen"
        imgui.text(f"cube      {seen}   {state.reprojection_error:.2f} px")
        imgui.text(f"top       {controls.top_face}   turns {controls.turns:+.2f}")
        imgui.text(f"heading   {np.degrees(controls.heading):+.0f} deg")
        imgui.text(f"character {step.posed.state}   speed {step.posed.speed:.2f}")
        imgui.text(f"robot     {robot.link}   {robot.label} {robot.mood:+.2f}")
        imgui.separator()
        imgui.text(KEY_HELP)
        imgui.end()

    def _on_key(self, _window: Any, key: int, _scan: int, action: int, _mods: int) -> None:
        if action == glfw.PRESS:
            self.press(key)

    def press(self, key: int) -> None:
        """Handle a key press; `key` is one of GLFW's constants."""
        if key in (glfw.KEY_ESCAPE, glfw.KEY_Q):
            glfw.set_window_should_close(self._window, True)
        elif key == glfw.KEY_H:
            self._panel = not self._panel
        elif key == glfw.KEY_C:
            self._clear = True
        elif key in SCENARIO_KEYS:
            self._scenario = SCENARIO_KEYS[key]
        elif key == glfw.KEY_F:
            self._toggle_full_screen()

    def _toggle_full_screen(self) -> None:
        if glfw.get_window_monitor(self._window):
            no_monitor: Any = None  # windowed; glfw's type hints do not allow None
            glfw.set_window_monitor(self._window, no_monitor, 60, 60, *_fitting(self._size), 0)
            return
        monitor = glfw.get_primary_monitor()
        mode = glfw.get_video_mode(monitor)
        wide, high = mode.size
        glfw.set_window_monitor(self._window, monitor, 0, 0, wide, high, mode.refresh_rate)

    def _store_error(self, _code: int, text: bytes | str) -> None:
        self._error = text.decode(errors="replace") if isinstance(text, bytes) else text


def _fitting(size: tuple[int, int]) -> tuple[int, int]:
    """Return the largest window for pictures of `size` that fits on the desktop."""
    with contextlib.suppress(Exception):
        _, _, wide, high = glfw.get_monitor_workarea(glfw.get_primary_monitor())
        scale = min(1.0, 0.95 * wide / size[0], 0.92 * high / size[1])
        return round(size[0] * scale), round(size[1] * scale)
    return size
