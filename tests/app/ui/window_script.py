"""Opens the window and presses its keys; `test_window` runs this in its own process."""

import sys

import glfw
import numpy as np

from app.pipeline.playground import Playground
from app.pipeline.step import RobotView
from app.running.opening import intrinsics_for
from app.ui.notice import Notice
from app.ui.window import Window
from tracking import open_source


def main(session: str) -> None:
    """Show the first frame of a session, press every key, and quit."""
    robot = RobotView("ready", 0.5, "happy")
    with open_source(session) as source, Window(source.size) as window:
        intrinsics = intrinsics_for(source.intrinsics, source.size)
        playground = Playground("companion", intrinsics, context=window.context)
        step = playground.step(next(iter(source)))
        assert step.picture is not None
        assert not window.show(step, robot).clear
        # What was swapped away is undefined, so paint once more before looking.
        window.paint(step.picture)
        screen = window.context.detect_framebuffer(0)
        shown = np.frombuffer(screen.read(), np.uint8).reshape(*screen.size[::-1], 3)
        assert screen.size == source.size
        np.testing.assert_array_equal(shown[::-1, :, ::-1], step.picture)

        window.wait(None)
        for _ in range(2):  # both of the buffers that are swapped
            window.wait(Notice("Camera lost", "Plug it in again."))
        shown = np.frombuffer(screen.read(), np.uint8)
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
