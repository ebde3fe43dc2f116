"""Opens the window and presses its keys; `test_window` runs this in its own process."""

import sys

import glfw
import numpy as np
from numpy.typing import NDArray

from cubeling.app.pipeline.playground import Playground
from cubeling.app.pipeline.step import RobotView, Step
from cubeling.app.preferences import PreferenceStore
from cubeling.app.running.kept_lens import intrinsics_for
from cubeling.app.ui.cards.shown_step import scaled_rect
from cubeling.app.ui.notice import Notice
from cubeling.app.ui.playback.requests import Record, Seek
from cubeling.app.ui.window import Window
from cubeling.tracking import open_source


def pictures_of(window: Window, step: Step, robot: RobotView) -> NDArray[np.uint8]:
    """Return what a window shows of a step."""
    for _ in range(2):  # both of the buffers that are swapped
        window.show(step, robot)
    return window.pixels()


def main(session: str) -> None:
    """Show the first frame of a session, press every key, and quit."""
    robot = RobotView("ready", 0.5, "happy")
    store = PreferenceStore(None, {"welcomed": True})
    with open_source(session) as source, Window(source.size, preferences=store) as window:
        intrinsics = intrinsics_for(source.intrinsics, source.size)
        playground = Playground("companion", intrinsics, context=window.context)
        step = playground.step(next(iter(source)))
        assert step.picture is not None
        assert not window.show(step, robot).clear
        # What was swapped away is undefined, so paint once more before looking.
        for with_opengl in (True, False):
            window.paint(step.picture, with_opengl=with_opengl)
            np.testing.assert_array_equal(window.pixels(), step.picture)

        mirrored = scaled_rect(step.subjects[0], 2.0, step.picture.shape[1])
        assert mirrored[0] == 2 * (source.size[0] - step.subjects[0][2])
        plain = pictures_of(window, step, robot)
        window.press(glfw.KEY_M)
        turned = pictures_of(window, step, robot)
        upper = np.s_[300:420, 300:900]  # without cards
        np.testing.assert_array_equal(turned[upper], plain[:, ::-1][upper])
        window.press(glfw.KEY_M)

        place = glfw.get_window_pos(window._window), glfw.get_window_size(window._window)
        for full in (True, False):
            window.press(glfw.KEY_F)
            window.show(step, robot)
            assert bool(glfw.get_window_monitor(window._window)) == full
        assert place == (
            glfw.get_window_pos(window._window),
            glfw.get_window_size(window._window),
        )

        window.press(glfw.KEY_LEFT, shift=True)
        window.press(glfw.KEY_R)
        assert window.take_requests() == (Seek(-1.0), Record())
        assert not window.take_requests()

        window.wait(None)
        for _ in range(2):  # both of the buffers that are swapped
            window.wait(Notice("Camera lost", "Plug it in again."))
        shown = window.pixels()
        assert shown.mean() < 0.7 * step.picture.mean(), "the last picture is not dimmed"
        assert shown.max() > 200, "no card lies over it"
        for key in (glfw.KEY_P, glfw.KEY_C):
            window.press(key)
        assert window.show(step, robot).clear
        assert not window.show(step, robot).clear
        window.press(glfw.KEY_3)
        assert window.show(step, robot).scenario == "companion"
        assert window.show(step, robot).scenario == ""
        quits = [window.closed]
        window.press(glfw.KEY_ESCAPE)
        quits.append(window.closed)
        assert quits == [False, True]
        playground.close()
    window.close()  # again: does nothing
    assert window.closed


if __name__ == "__main__":
    main(sys.argv[1])
