"""Paints a window in memory, which costs a fifth of a software driver's time."""

from collections.abc import Sequence

import cv2
import numpy as np
from numpy.typing import NDArray

from cubeling.app.ui.canvas import Card
from cubeling.app.ui.window.kept_cards import KeptCards
from cubeling.app.ui.window.painter import AROUND_BGR, Picture, Placement
from cubeling.app.ui.window.shared_picture import SharedPicture

Pixels = NDArray[np.uint8]


class MemoryPainter:
    """A `Painter` of a window that shows a `SharedPicture`; it closes that."""

    def __init__(self, shared: SharedPicture) -> None:
        self._shared = shared
        self._pixels: Pixels = np.empty((0, 0, 4), np.uint8)
        self._place: Placement | None = None
        self._cards = KeptCards(_blended_parts, lambda parts: None)

    def paint(
        self, picture: Picture, place: Placement, *, mirrored: bool, brightness: float
    ) -> None:
        """Copy a picture into the shared memory, as large as it is shown."""
        self._pixels = self._shared.pixels(*place.window)
        self._place = place
        if place.whole != place.window:
            self._pixels[:] = (*AROUND_BGR, 255)
        if place.shown != (picture.shape[1], picture.shape[0]):
            picture = np.asarray(cv2.resize(picture, place.shown), np.uint8)
        if mirrored:
            picture = np.asarray(cv2.flip(picture, 1), np.uint8)
        if brightness != 1.0:
            picture = np.asarray(cv2.convertScaleAbs(picture, alpha=brightness), np.uint8)
        cv2.cvtColor(picture, cv2.COLOR_BGR2BGRA, dst=self._shown)
        self._cards.begin()

    def paint_cards(self, cards: Sequence[Card]) -> None:
        """Blend cards over it; they are clipped to the window."""
        assert self._place is not None
        high, wide = self._pixels.shape[:2]
        for card in cards:
            color, left_of = self._cards.of(card)
            height, width = color.shape[:2]
            x, y = self._place.left + card.x, self._place.top + card.y
            rows, columns = slice(max(-y, 0), high - y), slice(max(-x, 0), wide - x)
            part = self._pixels[max(y, 0) : y + height, max(x, 0) : x + width]
            if part.size:
                color, left_of = color[rows, columns], left_of[rows, columns]
                cv2.add(cv2.multiply(part, left_of, scale=1 / 255), color, dst=part)

    def show(self) -> None:
        """Let the server show it."""
        self._shared.show()

    def finish(self) -> None:
        """Wait until the server has copied it."""
        self._shared.finish()

    def pixels(self) -> Picture:
        """Return what was painted."""
        return np.asarray(cv2.cvtColor(self._pixels, cv2.COLOR_BGRA2BGR), np.uint8)

    def release(self) -> None:
        """Close the shared picture."""
        self._shared.close()

    @property
    def _shown(self) -> Pixels:
        """Where the picture is in the window."""
        assert self._place is not None
        left, top, (width, height) = self._place.left, self._place.top, self._place.shown
        return self._pixels[top : top + height, left : left + width]


def _blended_parts(card: Card) -> tuple[Pixels, Pixels]:
    """Return a card's part of a picture with it, and what is left of the picture below, 0…255."""
    opacity = np.round(255 * card.opacity).astype(np.uint8)
    shares = cv2.merge([opacity] * 4)
    color = cv2.cvtColor(card.color, cv2.COLOR_BGR2BGRA)
    return (
        np.asarray(cv2.multiply(color, shares, scale=1 / 255), np.uint8),
        np.asarray(cv2.bitwise_not(shares), np.uint8),
    )
