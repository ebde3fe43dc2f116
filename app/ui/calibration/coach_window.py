"""The coach in a window."""

import numpy as np
from numpy.typing import NDArray

from cubeling.app.ui.calibration.coach import CoachView
from cubeling.app.ui.calibration.session import Advice
from cubeling.app.ui.window.surface import WindowSurface

Picture = NDArray[np.uint8]


class CoachWindow(WindowSurface):
    """A window with the live picture and the coach over it; Esc ends the session.

    `size` is that of the pictures, (width, height) [px]; `target` is "cube" or "board".
    """

    def __init__(self, size: tuple[int, int], target: str) -> None:
        super().__init__(size, "Cubeling: calibrate")
        self._coach = CoachView(target)

    def show_advice(self, picture: Picture, timestamp: float, advice: Advice) -> None:
        """Show the picture with the advice over it."""
        if self.closed:
            return
        self.paint(self._coach.draw(picture, timestamp, advice))
        self.present()
