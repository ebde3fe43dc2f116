"""The live window: the picture with its cards, and a panel with details."""

import ctypes
import time
from collections import deque

# imgui-bundle contains the GLFW library that both must share, and sets its path on import.
from imgui_bundle import imgui  # isort: skip
import glfw
import numpy as np
from numpy.typing import NDArray

from app.pipeline.registry import SCENARIOS
from app.pipeline.scenario import Inputs
from app.pipeline.step import RobotView, Step
from app.ui.card_layout import CardLayout
from app.ui.notice import Notice
from app.ui.overlay import interrupted, overlay, virtual_robot_side
from app.ui.virtual_robot import VirtualRobot
from app.ui.window.surface import Surface

KEY_HELP = "Esc  quit      F  full screen      C  start over      H  this panel      "
SCENARIO_KEYS = {glfw.KEY_1 + place: name for place, name in enumerate(SCENARIOS)}
KEY_HELP += "   ".join(f"{place}  {name}" for place, name in enumerate(SCENARIOS, start=1))


class Window(Surface):
    """A `Screen` on the desktop; see `Surface` for its parameters and errors."""

    def __init__(self, size: tuple[int, int], title: str = "Cubeling") -> None:
        super().__init__(size, title)
        self._virtual_robot = VirtualRobot(self.context, virtual_robot_side(size[1]))
        self._layout = CardLayout()
        self._start_panel()
        self._shown_at: deque[float] = deque(maxlen=60)
        self._panel = False
        self._clear = False
        self._scenario = ""
        self._last: NDArray[np.uint8] | None = None

    def show(self, step: Step, robot: RobotView) -> Inputs:
        """Show a step, and return the keys that the player pressed."""
        if self.closed:
            return Inputs()
        if step.picture is not None:
            self._last = overlay(step.picture, step, robot, self._virtual_robot, self._layout)
            self.paint(self._last)
        self._shown_at.append(time.perf_counter())
        self._draw_panel(step, robot)
        self.present()
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

    def release(self) -> None:
        """Release the panel and the virtual robot."""
        imgui.backends.opengl3_shutdown()
        imgui.backends.glfw_shutdown()
        imgui.destroy_context()
        self._virtual_robot.close()

    def _start_panel(self) -> None:
        # imgui chains to the callbacks that are already set.
        imgui.create_context()
        imgui.get_io().set_ini_filename("")
        address = ctypes.cast(self._window, ctypes.c_void_p).value
        assert address is not None, "the window is open"
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

    def press(self, key: int) -> None:
        """Handle a key press; `key` is one of GLFW's constants."""
        super().press(key)
        if key == glfw.KEY_H:
            self._panel = not self._panel
        elif key == glfw.KEY_C:
            self._clear = True
        elif key in SCENARIO_KEYS:
            self._scenario = SCENARIO_KEYS[key]
        elif key == glfw.KEY_F:
            self.toggle_full_screen()
