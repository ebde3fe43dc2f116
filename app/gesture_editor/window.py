"""The editor in a window of the desktop."""

from pathlib import Path
from typing import Any

import glfw

from cubeling.app.gesture_editor.handling import (
    Dropped,
    Event,
    KeyPressed,
    Moved,
    Pressed,
    Released,
    Typed,
)
from cubeling.app.gesture_editor.panels.cards import HEIGHT, WIDTH
from cubeling.app.gesture_editor.session import EditorSession
from cubeling.app.ui.window.surface import TYPED_KEYS, WindowSurface, key_name

EDITING_KEYS = {glfw.KEY_DELETE: "Delete", glfw.KEY_BACKSPACE: "Backspace"}
"""Names of keys that other windows have no use for."""

MIN_SCALE, MAX_SCALE = 1.0, 2.0
"""Pixels for a unit of the canvas; a window beyond that shows an enlarged picture."""

FRAME_S = 1 / 30
"""Time between two pictures, at least [s]."""

MAX_ELAPSED_S = 0.1
"""Time that one picture advances the preview, at most [s]."""

SIZE = round(WIDTH), round(HEIGHT)
"""Size of the window at first [screen coordinates]."""


class EditorWindow(WindowSurface):
    """A window with an `EditorSession` in it; see `Surface` for who closes it.

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
        glfw.set_window_size_limits(self._window, SIZE[0] // 2, SIZE[1] // 2, -1, -1)
        self._events: list[Event] = []
        self._session: EditorSession | None = None
        try:
            self._session = EditorSession(self.context, folder, character, name)
        except BaseException:
            self.close()
            raise

    @property
    def session(self) -> EditorSession:
        """The editor."""
        assert self._session is not None, "it was opened"
        return self._session

    def run(self) -> None:
        """Edit until the user ends it."""
        last = glfw.get_time()
        while not self.session.closed:
            glfw.wait_events_timeout(max(FRAME_S - (glfw.get_time() - last), 1e-3))
            now = glfw.get_time()
            self.frame(min(now - last, MAX_ELAPSED_S))
            last = now

    def frame(self, elapsed: float) -> None:
        """Handle what has happened, and show a picture."""
        events, self._events = self._events, []
        self.session.send(*events)
        if self.session.closed:
            return
        self.session.advance(elapsed)
        self.paint(self.session.picture(self._scale))
        self.present()

    def release(self) -> None:
        """Close the session."""
        if self._session is not None:
            self._session.close()

    def handle_pointer(self, x: float, y: float) -> None:
        """Handle the mouse."""
        self._events.append(Moved(x / self._scale, y / self._scale))

    @property
    def _scale(self) -> float:
        """Pixels of a picture for a unit of the canvas."""
        wide, high = glfw.get_framebuffer_size(self._window)
        return min(max(min(wide / WIDTH, high / HEIGHT), MIN_SCALE), MAX_SCALE)

    def _on_button(self, _window: Any, button: int, action: int, mods: int) -> None:
        if button == glfw.MOUSE_BUTTON_LEFT:
            shift = bool(mods & glfw.MOD_SHIFT)
            self._events.append(Pressed(shift) if action == glfw.PRESS else Released())

    def _on_key(self, _window: Any, key: int, scan: int, action: int, mods: int) -> None:
        name = EDITING_KEYS.get(key) or key_name(key, scan)
        if name is None or action not in (glfw.PRESS, glfw.REPEAT):
            return
        control = bool(mods & (glfw.MOD_CONTROL | glfw.MOD_SUPER))
        if name == "F" and not control and not self.session.state.focus:
            self.toggle_full_screen()
        elif name == "V" and control:
            pasted: Any = glfw.get_clipboard_string(self._window) or b""
            self._events.append(Typed(bytes(pasted).decode(errors="replace")))
        else:
            self._events.append(KeyPressed(name, bool(mods & glfw.MOD_SHIFT), control))

    def _on_character(self, _window: Any, code: int) -> None:
        letter = chr(code)
        if letter in TYPED_KEYS and not self.session.state.focus:
            self._events.append(KeyPressed(letter))
        else:
            self._events.append(Typed(letter))

    def _on_drop(self, _window: Any, paths: list[str]) -> None:
        self._events += [Dropped(path) for path in paths[:1]]

    def _on_close(self, _window: Any) -> None:
        glfw.set_window_should_close(self._window, False)
        self.session.ask_to_quit()


def edit(folder: Path, character: str, name: str) -> None:
    """Open the editor, and return when the user has ended it."""
    with EditorWindow(folder, character, name) as window:
        window.run()
