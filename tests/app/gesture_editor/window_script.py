"""Opens the editor's window and makes a gesture; `test_window` runs this in its own process."""

import sys
from pathlib import Path

import glfw
import numpy as np

from cubeling.app.gesture_editor.panels.layout import widget_named
from cubeling.app.gesture_editor.tour import Hand
from cubeling.app.gesture_editor.window import EditorWindow
from cubeling.characters.behaviour.gestures.files import load_gesture


def main(folder: str) -> None:
    """Put a hand somewhere, name the gesture, save it and quit, by GLFW's callbacks."""
    with EditorWindow(Path(folder), "robot") as window:
        window.frame(0.0)
        screen = window.context.detect_framebuffer(0)
        window.paint(window.session.picture(1.0))
        shown = np.frombuffer(screen.read(), np.uint8).reshape(*screen.size[::-1], 3)
        np.testing.assert_array_equal(shown[::-1, :, ::-1], window.session.picture(1.0))

        map_ = widget_named(window.session.state, "map")
        assert map_ is not None
        handle = window._window
        window._on_pointer(handle, map_.rect[0] + 120.0, map_.rect[1] + 60.0)
        for action in (glfw.PRESS, glfw.RELEASE):
            window._on_button(handle, glfw.MOUSE_BUTTON_LEFT, action, 0)
        window.frame(0.1)
        assert len(window.session.state.document.gesture.right) == 1

        window._on_close(handle)  # not before it is saved
        window.frame(0.1)
        assert not window.session.closed
        assert window.session.state.card == "unsaved"
        window._on_key(handle, glfw.KEY_ESCAPE, 0, glfw.PRESS, 0)
        window._on_key(handle, glfw.KEY_S, 0, glfw.PRESS, glfw.MOD_CONTROL)
        window.frame(0.1)
        for letter in "mine":
            window._on_character(handle, ord(letter))
        window._on_key(handle, glfw.KEY_ENTER, 0, glfw.PRESS, 0)
        window.frame(0.1)
        saved = load_gesture(Path(folder) / "mine.toml")
        assert saved == window.session.state.document.gesture

        window._on_drop(handle, ["walk.bvh"])
        window.frame(0.1)
        assert window.session.state.text("recording") == "walk.bvh"
        window._on_key(handle, glfw.KEY_ESCAPE, 0, glfw.PRESS, 0)
        Hand(window.session).click("shape:fist")
        window._on_key(handle, glfw.KEY_Z, 0, glfw.PRESS, glfw.MOD_CONTROL)
        window._on_close(handle)
        window.run()
        assert window.session.closed


if __name__ == "__main__":
    main(sys.argv[1])
