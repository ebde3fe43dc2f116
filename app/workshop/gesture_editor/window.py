"""The editor in a window of the desktop."""

from pathlib import Path
from typing import Any

# imgui-bundle contains the GLFW library that both must share, and sets its path on import.
from imgui_bundle import imgui  # isort: skip
import glfw

from cubeling.app.ui.panels.drawing.backend import ImGuiBackend, ui_scale
from cubeling.app.ui.panels.drawing.style import rgba
from cubeling.app.ui.window.surface import WindowSurface
from cubeling.app.workshop.gesture_editor.editing.actions import drop_file
from cubeling.app.workshop.gesture_editor.panels.ui import DESK
from cubeling.app.workshop.gesture_editor.panels.view import EditorView
from cubeling.app.workshop.gesture_editor.session import EditorSession

FRAME_S = 1 / 30
"""Time between two pictures, at least [s]."""

MAX_ELAPSED_S = 0.1
"""Time that one picture advances the preview, at most [s]."""

SIZE = 1360, 780
"""Size of the window at first [screen coordinates]."""

MIN_SIZE = 640, 360
"""Least size of the window [screen coordinates]."""


class EditorWindow(WindowSurface):
    """A window with an `EditorSession` in it; see `WindowSurface` for who closes it.

    Parameters
    ----------
    folder, character, name
        Those of the session.
    size
        Width and height of the window [screen coordinates].

    Raises
    ------
    AppError
        There is no display, or its driver offers no OpenGL 3.3.
    CharacterError
        See `EditorSession`.
    """

    def __init__(
        self,
        folder: Path,
        character: str = "human",
        name: str = "",
        size: tuple[int, int] = SIZE,
    ) -> None:
        super().__init__(size, "Cubeling: gesture editor")
        on_drop: Any = self._on_drop  # glfw's type hints know the callback in C
        glfw.set_drop_callback(self._window, on_drop)
        glfw.set_window_close_callback(self._window, self._on_close)
        glfw.set_window_size_limits(self._window, *MIN_SIZE, -1, -1)
        self._session: EditorSession | None = None
        self._view: EditorView | None = None
        self._backend = ImGuiBackend(self._window)
        try:
            self._session = EditorSession(self.context, folder, character, name)
            self._view = EditorView(self._session, self.context)
        except BaseException:
            self.close()
            raise

    @property
    def session(self) -> EditorSession:
        """The session that it shows; there is one once it was opened."""
        assert self._session is not None, "it was opened"
        return self._session

    @property
    def view(self) -> EditorView:
        """What draws the session; there is one once it was opened."""
        assert self._view is not None, "it was opened"
        return self._view

    def run(self) -> None:
        """Edit until the user ends it."""
        last = glfw.get_time()
        while not self.session.closed:
            glfw.wait_events_timeout(max(FRAME_S - (glfw.get_time() - last), 1e-3))
            now = glfw.get_time()
            self.frame(min(now - last, MAX_ELAPSED_S))
            last = now

    def frame(self, elapsed: float) -> None:
        """Show a picture, and do what the user asks for."""
        size = glfw.get_framebuffer_size(self._window)
        if 0 in size:  # an iconified window
            self.poll()
            return
        self.session.advance(elapsed)
        with self._backend.frame():
            self.view.draw(ui_scale(self._window))
            full = imgui.shortcut(int(imgui.Key.f), imgui.InputFlags_.route_global)
        screen = self.context.detect_framebuffer(0)
        screen.use()
        screen.viewport = (0, 0, *size)
        screen.clear(*rgba(DESK))
        self._backend.render()
        self.present()
        if full and not self.session.state.card:
            self.toggle_full_screen()

    def release(self) -> None:
        """Close the session, and what shows it."""
        if self._view is not None:
            self._view.release()
        if self._session is not None:
            self._session.close()
        self._backend.close()

    def handle_key(self, key: str, *, shift: bool = False, repeated: bool = False) -> None:
        """Leave the keys to the panels."""

    def _on_drop(self, _window: Any, paths: list[str]) -> None:
        if paths:
            self.session.do(lambda state: drop_file(state, paths[0]))

    def _on_close(self, _window: Any) -> None:
        glfw.set_window_should_close(self._window, False)
        self.session.ask_to_quit()


def edit(folder: Path, character: str, name: str) -> None:
    """Open the editor, and return when the user has ended it."""
    with EditorWindow(folder, character, name) as window:
        window.run()
