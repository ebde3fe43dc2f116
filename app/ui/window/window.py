"""The live window: the picture with its cards, what the player asks for, and the panels."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import glfw
import numpy as np
from numpy.typing import NDArray

from cubeling.app.pipeline.registry import scenario_names
from cubeling.app.pipeline.scenario import Inputs
from cubeling.app.pipeline.step import Rect, RobotView, Step
from cubeling.app.preferences import PreferenceStore
from cubeling.app.ui.canvas import PICTURE_HEIGHT, Card
from cubeling.app.ui.cards.hint_reader import HintReader
from cubeling.app.ui.cards.layout import CardLayout
from cubeling.app.ui.cards.overlay import cards_over, notice_card, virtual_robot_side
from cubeling.app.ui.cards.shown_step import shown_step
from cubeling.app.ui.cards.virtual_robot import VirtualRobot
from cubeling.app.ui.notice import Notice
from cubeling.app.ui.panels.drawing.layer import PanelLayer
from cubeling.app.ui.panels.monitor import SessionMonitor
from cubeling.app.ui.playback.corner_buttons import ROOM_BELOW
from cubeling.app.ui.playback.layer import PlaybackLayer
from cubeling.app.ui.playback.requests import SessionRequest, WindowRequest
from cubeling.app.ui.playback.status import SessionStatus
from cubeling.app.ui.window.surface import WindowSurface

Picture = NDArray[np.uint8]

DIMMED_BRIGHTNESS = 0.45
"""Share of the last picture's brightness while no new frame comes."""


class Window(WindowSurface):
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
    preferences
        How it begins; it notes what the player changes, some of it when it is closed.
    monitor
        What the panels show; None for no panels.

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
        preferences: PreferenceStore | None = None,
        monitor: SessionMonitor | None = None,
    ) -> None:
        self._preferences = preferences = preferences or PreferenceStore()
        began = preferences.now
        width, height = size
        whole = width, height + round(strip * height / PICTURE_HEIGHT)
        super().__init__(whole, title, began.window_size)
        if began.full_screen:
            self.toggle_full_screen()
        self._layer = PlaybackLayer(
            scenario_names(),
            folder,
            {
                WindowRequest.PANELS: self._toggle_panels,
                WindowRequest.FULL_SCREEN: self.toggle_full_screen,
                WindowRequest.QUIT: self.quit,
            },
            self._picture_with_cards,
        )
        self._layer.mirrored = began.mirror
        # A player in front of a camera is asked once what to play.
        self._chooses = not strip and not (monitor and monitor.options.keeps_scenario)
        self._layer.shows_scenarios = self._chooses and not began.welcomed
        self._virtual_robot = VirtualRobot(
            self.context, virtual_robot_side(max(height, round(PICTURE_HEIGHT)))
        )
        self._layout = CardLayout(ROOM_BELOW)
        self._panels: PanelLayer | None = None
        if monitor is not None:
            self._panels = PanelLayer(self._window, self.context, monitor, preferences)
        self._panel_requests: list[SessionRequest] = []
        self._shown: tuple[Step, RobotView] | None = None
        self._pointer = (0.0, 0.0)
        self._titled = ""
        self._told = True
        self._hint_reader = HintReader()

    def show(self, step: Step, robot: RobotView) -> Inputs:
        """Show a step, and return what the player asks of the scenario."""
        self._present(self._hint_reader.update(step), robot)
        return self._layer.take_inputs()

    def preview(self, step: Step, robot: RobotView) -> None:
        """Show a step on the way to another one, without what it tells of a moment that passes."""
        self._present(step, robot, told=False)

    def _present(self, step: Step, robot: RobotView, *, told: bool = True) -> None:
        if self.closed:
            return
        if self._shown is not None and step.frame.timestamp < self._shown[0].frame.timestamp:
            self._layout = CardLayout(ROOM_BELOW)  # it goes on from an earlier frame
        self._shown, self._told = (step, robot), told
        self._redraw()

    def wait(self, notice: Notice | None) -> None:
        """Process events; show a notice over the last picture, or what has changed over it."""
        if self.closed:
            return
        if notice is not None and self._shown is not None:
            self._redraw(notice)
        elif self._layer.changed or (self._panels is not None and self._panels.busy):
            self._redraw()
        else:
            self.poll()

    def take_requests(self) -> tuple[SessionRequest, ...]:
        """Return what the player has asked of the session since the last call."""
        requests, self._panel_requests = self._panel_requests, []
        return (*self._layer.take_requests(), *requests)

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
        """Note how the window is left; release the panels and the virtual robot."""
        self._preferences.change(
            window_size=self.chosen_size,
            full_screen=self.fills_screen,
            mirror=self._layer.mirrored,
            welcomed=self._preferences.now.welcomed or self._chooses,
        )
        if self._panels is not None:
            self._panels.close()
        self._virtual_robot.close()

    def handle_key(self, key: str, *, shift: bool = False, repeated: bool = False) -> None:
        """Hand a key on to the layer over the picture."""
        self._layer.press(key, shift=shift, repeated=repeated)

    def handle_character(self, character: str) -> bool:
        """Hand a character on to the layer over the picture, if it takes text."""
        return self._layer.type(character)

    def handle_pointer(self, x: float, y: float) -> None:
        """Follow the mouse, in pixels of the picture."""
        scale = self._picture_scale
        self._pointer = x / scale, y / scale
        self._layer.point(*self._pointer)

    def handle_button(self, pressed: bool) -> None:
        """Handle the left button of the mouse, unless it is on a panel."""
        if not pressed:
            self._layer.release()
        elif self._panels is None or not self._panels.has_mouse:
            self._layer.click(*self._pointer)

    @property
    def _picture_scale(self) -> float:
        """Pixels of a picture for a unit of the canvas."""
        return 1.0 if self._picture is None else self._picture.shape[0] / PICTURE_HEIGHT

    @property
    def _picture(self) -> Picture | None:
        """The last picture, without cards."""
        return None if self._shown is None else self._shown[0].picture

    def _redraw(self, notice: Notice | None = None) -> None:
        """Draw the last step with everything over it, and show it; dimmed under a notice."""
        if self._shown is None:
            self.poll()
            return
        step, robot = self._shown
        over: list[Card] = []
        if step.picture is not None:
            height, width = step.picture.shape[:2]
            below = round(self._layer.strip_height * height / PICTURE_HEIGHT)
            size = self.shown_size(width, height, below)
            if min(size) > 0:  # else it is iconified
                cards = [] if notice is None else [notice_card(notice, size)]
                if notice is None and self._told and not self._layer.shows_scenarios:
                    cards = self._cards_of(step, robot, size)
                brightness = 1.0 if notice is None else DIMMED_BRIGHTNESS
                mirrored = self._layer.mirrored
                self.paint(
                    step.picture,
                    cards,
                    below,
                    mirrored=mirrored,
                    brightness=brightness,
                    with_opengl=self._panels is not None and self._panels.shown,
                )
                unit = size[1] / PICTURE_HEIGHT
                over = self._layer.cards(size, [card.box(unit) for card in cards])
        self._draw_over(over)

    def _cards_of(self, step: Step, robot: RobotView, size: tuple[int, int]) -> list[Card]:
        """Return the cards over a step whose picture is shown in a size [px]."""
        assert step.picture is not None
        step = shown_step(step, size[0] / step.picture.shape[1], self._layer.mirrored)
        step = replace(step, subjects=(*step.subjects, *self._panel_areas(size)))
        self._virtual_robot.fit(virtual_robot_side(size[1]))
        return cards_over(step, robot, size, self._virtual_robot, self._layout)

    def _picture_with_cards(self) -> Picture | None:
        """Return the last picture with its cards, to keep it; None before the first one."""
        if self._shown is None or self._shown[0].picture is None:
            return None
        step, robot = self._shown
        assert step.picture is not None
        picture = step.picture[:, ::-1] if self._layer.mirrored else step.picture
        height, width = picture.shape[:2]
        picture = np.ascontiguousarray(picture)
        for card in self._cards_of(step, robot, (width, height)):
            card.blend_over(picture)
        return picture

    def _draw_over(self, cards: Sequence[Card]) -> None:
        """Draw the panels over what was painted, cards over the panels, and show all."""
        if self._panels is not None and self._panels.shown:
            self._panel_requests += self._panels.draw(self._strip_height)
        self.paint_cards(cards)
        self.present()

    def _toggle_panels(self) -> None:
        if self._panels is not None:
            self._panels.toggle()

    @property
    def _strip_height(self) -> float:
        """Height of what lies under the pictures [screen coordinates]."""
        strip = self._layer.strip_height
        if self._picture is None or not strip:
            return 0.0
        high = int(glfw.get_window_size(self._window)[1])
        _, bottom = self.in_picture(0.0, float(high))
        _, top = self.in_picture(0.0, 0.0)
        return high * (bottom - float(self._picture.shape[0])) / (bottom - top)

    def _panel_areas(self, size: tuple[int, int]) -> list[Rect]:
        """Return where panels lie in a picture of a size [px], so that cards avoid them."""
        rects = [] if self._panels is None or self._picture is None else self._panels.rects
        scale = 1.0 if self._picture is None else size[1] / self._picture.shape[0]
        areas = [
            (*self.in_picture(left, top), *self.in_picture(left + wide, top + high))
            for left, top, wide, high in rects
        ]
        return [(scale * x, scale * y, scale * to_x, scale * to_y) for x, y, to_x, to_y in areas]
