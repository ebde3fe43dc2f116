"""The pattern in a window."""

import glfw

from app.latency.pattern import SIZE_PX, Picture
from app.ui.window import Window


class PatternWindow(Window):
    """A window that shows the pattern; F switches to full screen, Esc ends."""

    def __init__(self) -> None:
        super().__init__(SIZE_PX, "Cubeling: latency")

    def show_pattern(self, picture: Picture) -> None:
        """Show a picture of the pattern."""
        if not self.closed:
            self.paint(picture)
            glfw.swap_buffers(self._window)

    def poll(self) -> None:
        """Process events."""
        if not self.closed:
            glfw.poll_events()
