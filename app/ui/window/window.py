"""The live window: the picture with its cards, what the player asks for, and a panel."""

import ctypes
import time
from collections import deque
from dataclasses import replace
from pathlib import Path

# imgui-bundle contains the GLFW library that both must share, and sets its path on import.
from imgui_bundle import imgui  # isort: skip
import cv2
import glfw
import numpy as np
from numpy.typing import NDArray

from app.pipeline.registry import scenario_names
from app.pipeline.scenario import Inputs
from app.pipeline.step import RobotView, Step
from app.ui.canvas import PICTURE_HEIGHT
from app.ui.card_layout import CardLayout
from app.ui.notice import Notice
from app.ui.overlay import interrupted, overlay, virtual_robot_side
from app.ui.playback.layer import PlaybackLayer
from app.ui.playback.requests import SessionRequest, WindowRequest
from app.ui.playback.status import SessionStatus
from app.ui.virtual_robot import VirtualRobot
from app.ui.window.surface import Surface

Picture = NDArray[np.uint8]


class Window(Surface):
    """A `Screen` on the desktop.

    Parameters
    ----------
    size
        Width and height of the pictures [px].
    title
        Text of the title bar.
    folder
        Where snapshots go.
    strip
        Height of what lies under the pictures, in units of the canvas: room for a timeline.

    Raises
    ------
    AppError
        There is no display, or its driver offers no OpenGL 3.3.
    """

    attended = True

    def __init__(
        self,
        size: tuple[int, int],
        title: str = "Cubeling",
        folder: Path = Path(),
        strip: float = 0.0,
    ) -> None:
        width, height = size
        super().__init__((width, height + round(strip * height / PICTURE_HEIGHT)), title)
        self._layer = PlaybackLayer(
            scenario_names(),
            folder,
            {
                WindowRequest.PANEL: self._toggle_panel,
                WindowRequest.FULL_SCREEN: self.toggle_full_screen,
                WindowRequest.QUIT: self.quit,
            },
        )
        self._virtual_robot = VirtualRobot(self.context, virtual_robot_side(height))
        self._layout = CardLayout()
        self._start_panel()
        self._panel = False
        self._shown_at: deque[float] = deque(maxlen=60)
        self._shown: tuple[Step, RobotView] | None = None
        self._picture: Picture | None = None
        self._pointer = (0.0, 0.0)
        self._titled = ""

    def show(self, step: Step, robot: RobotView) -> Inputs:
        """Show a step, and return what the player asks of the scenario."""
        if self.closed:
            return Inputs()
        if self._shown is not None and step.frame.timestamp < self._shown[0].frame.timestamp:
            self._layout = CardLayout()  # it goes on from an earlier frame
        self._shown_at.append(time.perf_counter())
        self._shown = step, robot
        self._redraw()
        return self._layer.take_inputs()

    def wait(self, notice: Notice | None) -> None:
        """Process events; show a notice over the last picture, or what has changed over it."""
        if self.closed:
            return
        if notice is not None and self._picture is not None:
            self.paint(self._layer.draw(interrupted(self._picture, notice)))
            self._draw_over()
        elif self._layer.changed or self._panel:
            self._redraw()
        else:
            self.poll()

    def take_requests(self) -> tuple[SessionRequest, ...]:
        """Return what the player has asked of the session since the last call."""
        return self._layer.take_requests()

    def report(self, status: SessionStatus) -> None:
        """Show another state of the session."""
        self._layer.report(status)
        if status.scenario not in ("", self._titled):
            self._titled = status.scenario
            glfw.set_window_title(self._window, f"Cubeling: {status.scenario}")

    def notify(self, words: str) -> None:
        """Show a notice for some seconds."""
        self._layer.notify(words)

    def release(self) -> None:
        """Release the panel and the virtual robot."""
        imgui.backends.opengl3_shutdown()
        imgui.backends.glfw_shutdown()
        imgui.destroy_context()
        self._virtual_robot.close()

    def handle_key(self, key: str, *, shift: bool = False, repeated: bool = False) -> None:
        """Handle a key, unless it is typed into the panel."""
        if not imgui.get_io().want_text_input:
            self._layer.press(key, shift=shift, repeated=repeated)

    def handle_pointer(self, x: float, y: float) -> None:
        """Handle the mouse."""
        scale = self._picture_scale
        self._pointer = x / scale, y / scale
        self._layer.point(*self._pointer)

    def handle_button(self, pressed: bool) -> None:
        """Handle the left button of the mouse, unless it is on the panel."""
        if not pressed:
            self._layer.release()
        elif not imgui.get_io().want_capture_mouse:
            self._layer.click(*self._pointer)

    @property
    def _picture_scale(self) -> float:
        """Pixels of a picture for a unit of the canvas."""
        return 1.0 if self._picture is None else self._picture.shape[0] / PICTURE_HEIGHT

    def _redraw(self) -> None:
        """Draw the last step with everything over it, and show it."""
        if self._shown is None:
            self.poll()
            return
        step, robot = self._shown
        if step.picture is not None:
            step = mirrored(step) if self._layer.mirrored else step
            assert step.picture is not None
            self._fit_virtual_robot(step.picture.shape[0])
            self._picture = overlay(
                step.picture.copy(), step, robot, self._virtual_robot, self._layout
            )
            self.paint(self._layer.draw(self._picture))
        self._draw_over()

    def _draw_over(self) -> None:
        """Draw the panel over what was painted, and show both."""
        if self._shown is not None:
            self._draw_panel(*self._shown)
        self.present()

    def _fit_virtual_robot(self, height: int) -> None:
        """Draw the virtual robot as large as the pictures ask: another camera may have others."""
        side = virtual_robot_side(height)
        if side != self._virtual_robot.side:
            self._virtual_robot.close()
            self._virtual_robot = VirtualRobot(self.context, side)

    def _toggle_panel(self) -> None:
        self._panel = not self._panel

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
        imgui.end()


def mirrored(step: Step) -> Step:
    """Return a step whose picture is as in a mirror, to draw cards over it that can be read."""
    if step.picture is None:
        return step
    width = float(step.picture.shape[1])
    picture = np.asarray(cv2.flip(step.picture, 1), np.uint8)
    subjects = tuple(
        (width - right, top, width - left, bottom) for left, top, right, bottom in step.subjects
    )
    return replace(step, picture=picture, subjects=subjects)
