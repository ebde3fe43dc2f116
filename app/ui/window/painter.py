"""What paints pictures and cards into a window."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from cubeling.app.ui.canvas import Card

Picture = NDArray[np.uint8]

AROUND_BGR = 33, 26, 23
"""Colour of a window around the picture."""


@dataclass(frozen=True)
class Placement:
    """Where a picture lies in a window; all lengths in pixels of the window."""

    window: tuple[int, int]
    """Width and height of the window."""

    left: int
    """Left edge of the picture, and of what is below it."""

    top: int
    """Top edge of the picture, from the top of the window."""

    whole: tuple[int, int]
    """Width and height of the picture with what is below it."""

    shown: tuple[int, int]
    """Width and height of the picture."""


class Painter(Protocol):
    """Paints into a window; whoever creates it releases it, and a second `release` does nothing."""

    def paint(
        self, picture: Picture, place: Placement, *, mirrored: bool, brightness: float
    ) -> None:
        """Begin with a picture, (height, width, 3) BGR; `brightness` is 0…1."""

    def paint_cards(self, cards: Sequence[Card]) -> None:
        """Draw cards over it, whose places are in the picture as it is shown."""

    def show(self) -> None:
        """Show what was painted."""

    def finish(self) -> None:
        """Wait until the display has what was shown."""

    def pixels(self) -> Picture:
        """Return what was painted, (height, width, 3) BGR of the window; not what is shown."""

    def release(self) -> None:
        """Release what it holds, before the window."""
