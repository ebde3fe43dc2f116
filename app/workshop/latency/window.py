"""The pattern in a window."""

from cubeling.app.ui.window.picture_window import PictureWindow
from cubeling.app.workshop.latency.pattern import SIZE_PX, Picture


class PatternWindow(PictureWindow):
    """A window that shows the pattern; F switches to full screen, Esc ends."""

    def __init__(self) -> None:
        super().__init__(SIZE_PX, "Cubeling: latency")

    def show_pattern(self, picture: Picture) -> None:
        """Show a picture of the pattern."""
        self.show_picture(picture)
