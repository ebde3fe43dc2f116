"""Opens the editor's window and makes a gesture; `test_window` runs this in its own process."""

import subprocess
import sys
from pathlib import Path

# imgui-bundle contains the GLFW library that both must share, and sets its path on import.
from imgui_bundle import imgui  # isort: skip
import glfw
import numpy as np

from cubeling.app.workshop.gesture_editor.panels.ui import Rect
from cubeling.app.workshop.gesture_editor.session import EditorSession
from cubeling.app.workshop.gesture_editor.window import EditorWindow
from cubeling.characters.behaviour.gestures.files import load_gesture
from tools.gesture_tour import NAME, Hand, from_empty_to_saved

SIZE = 640, 380
"""Size of the window: it costs little to draw [px]."""

FRAMES = 2
"""Frames after each event: one that handles it, and one that shows what came of it."""

KEY_FRAMES = 4
"""Frames after keys: Dear ImGui takes each press and each release in one of its own."""

NAMES_OF_X = {"Enter": "Return", "Escape": "Escape", "Space": "space", "?": "question"}
"""Keys whose names differ in X."""


class XEditor:
    """The editor in a window, with the mouse and the keyboard of an X server."""

    def __init__(self, window: EditorWindow) -> None:
        self.session = window.session
        self._window = window
        self.frame()

    @property
    def places(self) -> dict[str, Rect]:
        """Where its widgets are."""
        return self._window.view.places

    def frame(self, count: int = FRAMES) -> None:
        """Let frames pass."""
        self._window.poll()  # else the first one would not know of the last event
        for _ in range(count):
            if not self.session.closed:
                self._window.frame(0.0)

    def move(self, x: float, y: float) -> None:
        """Move the mouse."""
        left, top = glfw.get_window_pos(self._window._window)
        self._use("mousemove", str(round(left + x)), str(round(top + y)))

    def button(self, *, pressed: bool) -> None:
        """Press or release the left button of the mouse."""
        self._use("mousedown" if pressed else "mouseup", "1")

    def press(self, keys: str) -> None:
        """Press and release keys."""
        *held, key = keys.split("+")
        named = NAMES_OF_X.get(key, key.lower() if len(key) == 1 else key)
        self._use("key", "+".join((*(each.lower() for each in held), named)))
        self.frame(KEY_FRAMES)

    def hold(self, key: str, *, pressed: bool) -> None:
        """Press or release "Shift" or "Ctrl"."""
        self._use("keydown" if pressed else "keyup", key.lower())

    def type(self, text: str) -> None:
        """Type letters."""
        self._use("type", text)
        self.frame(len(text))

    def _use(self, *arguments: str) -> None:
        subprocess.run(["xdotool", *arguments], check=True, timeout=10)
        self.frame()


def card(session: EditorSession) -> str:
    """Return what lies over the window now."""
    return session.state.card


def main(folder: str) -> None:
    """Repeat the tour by real keys and mouse, try to leave with changes, drop a file, and quit."""
    with EditorWindow(Path(folder), "robot", size=SIZE) as window:
        handle, session = window._window, window.session
        glfw.focus_window(handle)
        editor = XEditor(window)
        hand = Hand(editor)
        steps = list(from_empty_to_saved(editor))
        assert len(steps) == 7
        saved = load_gesture(Path(folder) / f"{NAME.lower().replace(' ', '_')}.toml")
        assert saved == session.state.document.gesture
        assert saved.expressivity.power == 0.5
        assert [key.path for key in saved.right] == ["line", "wave"]

        screen = window.context.detect_framebuffer(0)
        window._backend.render()  # what was swapped away is undefined
        shown = np.frombuffer(screen.read(), np.uint8).reshape(*screen.size[::-1], 3)
        assert screen.size == SIZE
        assert np.ptp(shown) > 200
        assert (shown > 200).all(axis=-1).mean() > 0.5, "it is not as pale as paper"

        hand.click("shape:fist")
        window._on_close(handle)  # not before it is saved
        editor.frame()
        quits = [session.closed]
        assert card(session) == "unsaved"
        editor.press("Escape")
        assert card(session) == ""
        window._on_drop(handle, ["walk.bvh"])
        editor.frame()
        assert session.state.text("recording") == "walk.bvh"
        editor.press("Escape")

        for full in (True, False):
            editor.press("F")
            assert window.fills_screen == full
        editor.press("?")
        assert card(session) == "keys"
        editor.press("Escape")
        editor.press("Ctrl+Z")
        assert not session.state.changed
        editor.press("Escape")
        quits.append(session.closed)
        assert quits == [False, True]
    window.close()  # again: does nothing
    assert imgui.get_current_context() is None


if __name__ == "__main__":
    main(sys.argv[1])
