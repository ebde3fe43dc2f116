"""Replays a session in a window until it ends, and leaves by key; `test_window` runs this."""

import sys

import glfw

from cubeling.app.cli import main
from cubeling.app.ui.window import Window


def press_at_the_end(window: Window, status) -> None:
    """Show the panels, mirror the picture, and press Enter a while after the end."""
    report(window, status)
    waits.append(status.ending is not None)
    if sum(waits) == 2 and status.ending is not None:
        window.press(glfw.KEY_P)
        window.press(glfw.KEY_M)
    if sum(waits) == 5:
        window.press(glfw.KEY_ENTER)


if __name__ == "__main__":
    report, waits = Window.report, list[bool]()
    Window.report = press_at_the_end  # type: ignore[method-assign, assignment]
    try:
        main()
    finally:
        print(f"waited {sum(waits)} times", file=sys.stderr)  # noqa: T201
