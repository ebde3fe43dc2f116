"""The window, opened for real on a screen that nobody sees."""

import shutil
import subprocess

import numpy as np
import pytest

from app.show.overlay import RobotView


@pytest.fixture
def screen(monkeypatch):
    """A virtual screen, as `.ci/run` installs it."""
    if shutil.which("Xvfb") is None:
        pytest.skip("Xvfb is not installed")
    server = subprocess.Popen(
        ["Xvfb", "-displayfd", "1", "-screen", "0", "1024x768x24", "-nolisten", "tcp"],
        stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL,
    )
    assert server.stdout is not None
    monkeypatch.setenv("DISPLAY", f":{int(server.stdout.readline())}")
    yield
    server.terminate()
    server.wait(timeout=10)
    server.stdout.close()


def test_the_window_shows_the_picture_and_the_cards(screen, a_step):
    from app.show.window import Window

    with Window((640, 360)) as window:
        step = a_step(window.context)
        inputs = window.show(step, RobotView("ready", 0.5, "happy"))
        shown = np.frombuffer(window.context.detect_framebuffer(0).read(), np.uint8)
        assert not inputs.clear
        assert not window.closed
        # The swapped-out buffer is undefined, so draw once more without swapping.
        window._paint(step.picture)
        wide, high = window.context.detect_framebuffer(0).size
        shown = np.frombuffer(window.context.detect_framebuffer(0).read(), np.uint8)
        seen = shown.reshape(high, wide, 3)[::-1, :, ::-1]
        np.testing.assert_array_equal(seen[:360, :640], step.picture)
    window.close()  # again: does nothing
    assert window.closed


def test_keys_start_over_show_the_panel_and_quit(screen, a_step):
    import glfw

    from app.show.window import Window

    with Window((320, 180)) as window:
        step = a_step(window.context)
        robot = RobotView("ready", 0.0, "neutral")
        for key in (glfw.KEY_H, glfw.KEY_C):
            window._key(window._window, key, 0, glfw.PRESS, 0)
        assert window.show(step, robot).clear
        assert not window.show(step, robot).clear
        window._key(window._window, glfw.KEY_ESCAPE, 0, glfw.PRESS, 0)
        assert window.closed
