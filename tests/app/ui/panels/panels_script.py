"""Opens a window with all panels and uses them; `test_panels` runs this in its own process."""

import itertools
import sys
import time
from pathlib import Path

# imgui-bundle contains the GLFW library that both must share, and sets its path on import.
from imgui_bundle import imgui  # isort: skip
import cv2
import glfw
import numpy as np

from cubeling.app.pipeline.frame_times import FrameTimes
from cubeling.app.pipeline.playground import Playground
from cubeling.app.pipeline.step import RobotView
from cubeling.app.preferences import PreferenceStore
from cubeling.app.running.kept_lens import intrinsics_for
from cubeling.app.session import SessionOptions
from cubeling.app.ui.panels import PANELS
from cubeling.app.ui.panels.drawing.layer import PanelLayer
from cubeling.app.ui.panels.drawing.places import Rect
from cubeling.app.ui.panels.monitor import SessionMonitor
from cubeling.app.ui.playback.requests import ChangeSetting, SessionRequest
from cubeling.characters.rendering import create_context
from cubeling.robot import Telemetry
from cubeling.tracking import open_source

SIZE = (1280, 720)
NO_WINDOW = 77
"""Exit code where GLFW makes no window without a display, as it needs EGL."""

BACKGROUND = (0.2, 0.5, 0.2)


class PanelWindow:
    """A window with nothing but the panels, and a mouse for them."""

    def __init__(self, session: str, store: PreferenceStore) -> None:
        glfw.init_hint(glfw.PLATFORM, glfw.PLATFORM_NULL)  # no display is needed
        glfw.init()
        for hint, value in (
            (glfw.CONTEXT_VERSION_MAJOR, 3),
            (glfw.CONTEXT_VERSION_MINOR, 3),
            (glfw.OPENGL_PROFILE, glfw.OPENGL_CORE_PROFILE),
            (glfw.CONTEXT_CREATION_API, glfw.EGL_CONTEXT_API),
        ):
            glfw.window_hint(hint, value)
        self.window = glfw.create_window(*SIZE, "panels", None, None)
        if not self.window:
            sys.exit(NO_WINDOW)
        glfw.make_context_current(self.window)
        self.context = create_context(window=True)
        options = SessionOptions(scenario="companion", source=session, robot="sim")
        monitor = SessionMonitor(options, FrameTimes(time.perf_counter))
        with open_source(session) as source:
            playground = Playground("companion", intrinsics_for(source.intrinsics, source.size))
            robot = RobotView("ready", 0.0, "neutral", telemetry=Telemetry("ready"))
            for frame in itertools.islice(source, 10):
                monitor.update(playground.step(frame), robot, playground)
        for part in ("tracking", "drawing"):
            monitor.times.lap(part)
        monitor.times.end_frame()
        self.layer = PanelLayer(self.window, self.context, monitor, store)

    def draw(self, frames: int = 1) -> list[SessionRequest]:
        """Draw some frames; return what was changed."""
        changes: list[SessionRequest] = []
        for _ in range(frames):
            glfw.poll_events()
            self.context.detect_framebuffer(0).clear(*BACKGROUND)
            changes += self.layer.draw()
        return changes

    def picture(self) -> np.ndarray:
        """Return what was drawn, (height, width, 3) BGR."""
        screen = self.context.detect_framebuffer(0)
        pixels = np.frombuffer(screen.read(), np.uint8).reshape(*screen.size[::-1], 3)
        return np.ascontiguousarray(pixels[::-1, :, ::-1])

    def drag(self, start: tuple[float, float], end: tuple[float, float]) -> list[SessionRequest]:
        """Press the left button at a place, and release it at another one."""
        io = imgui.get_io()
        changes = self._point(start)
        io.add_mouse_button_event(0, True)
        changes += self.draw(3) + self._point(end)
        io.add_mouse_button_event(0, False)
        return changes + self.draw(3)

    def _point(self, place: tuple[float, float]) -> list[SessionRequest]:
        """Move the mouse there; GLFW reports no event for this, so Dear ImGui gets its own."""
        glfw.set_cursor_pos(self.window, *place)
        imgui.get_io().add_mouse_pos_event(*place)
        return self.draw(3)

    @property
    def rects(self) -> dict[str, Rect]:
        """The places of the open panels."""
        board = self.layer._board
        return {name: (*panel.corner, *panel.size) for name, panel in board._open.items()}


def main(session: str, folder: str) -> None:
    """Draw every panel, move one, change a setting, open and close some, and resize the window."""
    store = PreferenceStore(None, {"panels": tuple(PANELS), "panels_shown": False})
    window = PanelWindow(session, store)
    window.draw()
    empty = window.picture()
    assert (empty == empty[0, 0]).all(), "hidden panels draw something"
    window.layer.toggle()
    window.draw(6)
    drawn = window.picture()
    cv2.imwrite(str(Path(folder) / "panels.png"), drawn)
    assert set(window.rects) == {"list", *PANELS}
    for name, (left, top, wide, high) in window.rects.items():
        part = drawn[round(top) : round(top + high), round(left) : round(left + wide)]
        pale = (part > 200).all(axis=-1).mean()
        assert pale > 0.6, f"{name} is not as pale as paper: {pale:.2f}"
        assert (part.max(axis=-1) < 120).any(), f"{name} has no ink"
        assert left >= 0
        assert top >= 0
        assert left + wide <= SIZE[0], f"{name} leaves the window"
    corner = window.rects["list"]
    assert (drawn[round(corner[1]), round(corner[0])] == empty[0, 0]).all(), "no round corner"

    left, top, wide, high = window.rects["emotion"]
    window.drag((left + 60, top + 16), (left + 60 - 200, top + 16 + 50))
    assert np.allclose(window.rects["emotion"][:2], (left - 200, top + 50), atol=1.0)
    (entry,) = (each for each in store.now.panels if each.startswith("emotion"))
    assert "@" in entry
    assert "tracking" in store.now.panels

    left, top, wide, high = window.rects["scenario"]
    changes = window.drag((left + 0.6 * wide, top + 64), (left + wide - 25, top + 64))
    last = changes[-1]
    assert isinstance(last, ChangeSetting)
    assert last.setting == "turns"
    assert float(last.value) > 5.0

    left, top, wide, high = window.rects["list"]
    place = left + 24, top + high - 20
    window.drag(place, place)
    assert "speech" not in window.rects
    window.drag(place, place)
    assert "speech" in window.rects
    left, top, wide, high = window.rects["tracking"]
    window.drag((left + wide - 20, top + 18), (left + wide - 20, top + 18))
    assert "tracking" not in window.rects
    assert all(not each.startswith("tracking") for each in store.now.panels)

    glfw.set_window_size(window.window, 800, 600)
    for _ in range(100):
        window.draw()
        if glfw.get_framebuffer_size(window.window) == (800, 600):
            break
    window.draw(3)
    for name, (left, top, wide, high) in window.rects.items():
        assert left + wide <= 800.5, f"{name} leaves the window: {left + wide}"
        assert top + high <= 600.5, f"{name} leaves the window"
    window.layer.close()
    glfw.terminate()


if __name__ == "__main__":
    main(*sys.argv[1:])
