"""A window that shows pictures, without a session."""

import glfw
import numpy as np
from numpy.typing import NDArray

from cubeling.app.ui.window.window import Window


class PictureWindow(Window):
    """A window for pictures; F switches to full screen, Esc ends."""

    def show_picture(self, picture: NDArray[np.uint8]) -> None:
        """Show a picture, (height, width, 3) BGR."""
        if not self.closed:
            self.paint(picture)
            self._painter.show()

    def poll(self) -> None:
        """Process the window's events, unless it is closed."""
        if not self.closed:
            glfw.poll_events()
