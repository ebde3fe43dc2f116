"""The gesture space as a map: the sectors across and up, around a figure that faces you."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from cubeling.app.gesture_editor.editing.state import EditorState
from cubeling.app.gesture_editor.panels.widgets import ACCENT, CARD, SUBTLE, Look, Widget, rounded
from cubeling.app.ui.canvas import Canvas
from cubeling.app.ui.palette import INK, PAPER, RULE, between
from cubeling.characters.behaviour import SECTORS_X, SECTORS_Y, Place

LABEL_WIDTH, LABEL_HEIGHT = 62.0, 18.0
"""Room for the names of rows, to the left, and of columns, above."""

FIGURE = between(PAPER, INK, 0.16)
"""Colour of the figure."""

HAND_RADIUS = 8.0
"""Of the disc that stands for the hand."""


@dataclass(frozen=True)
class SpaceMap(Widget):
    """The sectors of a hand; a click or a drag puts the hand into one."""

    place: Place | None
    """Where the hand is; None for nowhere."""

    left_hand: bool
    """Whether it is the left hand, whose own side is to the right of the map."""

    change: Callable[[EditorState, str, str], EditorState]
    """Puts the hand into a sector across and a sector up."""

    @property
    def takes_mouse(self) -> bool:
        """Always."""
        return True

    @property
    def columns(self) -> tuple[str, ...]:
        """Sectors across, from left to right on the map."""
        return SECTORS_X[::-1] if self.left_hand else SECTORS_X

    def draw(self, canvas: Canvas, look: Look) -> None:
        """Draw the figure, the sectors, their names, and the hand."""
        left, top, width, height = self._grid
        wide, high = width / len(SECTORS_X), height / len(SECTORS_Y)
        rounded(canvas, self._grid, 8, CARD)
        self._figure(canvas)
        if self.place is not None and not self.place.contact:
            self._sector(canvas, self.place, wide, high)
        for number, name in enumerate(self.columns):
            x = left + (number + 0.5) * wide
            canvas.text(x, top - 5, name[1:], 12, SUBTLE, "middle")
            if number:
                edge = left + number * wide
                canvas.line([[edge, top], [edge, top + height]], RULE, 1.2)
        for number, name in enumerate(SECTORS_Y):
            y = top + (number + 0.5) * high
            canvas.text(left - 7, y + 4, name[1:], 12, SUBTLE, "right")
            if number:
                edge = top + number * high
                canvas.line([[left, edge], [left + width, edge]], RULE, 1.2)
        self._hand(canvas)

    def press(self, state: EditorState, x: float, y: float) -> EditorState:
        """Put the hand into the sector under the mouse."""
        return self.drag(state, x, y)

    def drag(self, state: EditorState, x: float, y: float) -> EditorState:
        """Put the hand into the sector under the mouse."""
        left, top, width, height = self._grid
        column = int(np.clip((x - left) / width * len(SECTORS_X), 0, len(SECTORS_X) - 1))
        row = int(np.clip((y - top) / height * len(SECTORS_Y), 0, len(SECTORS_Y) - 1))
        return self.change(state, self.columns[column], SECTORS_Y[row])

    def center(self, x: str, y: str) -> tuple[float, float]:
        """Return where the middle of a sector is on the canvas."""
        left, top, width, height = self._grid
        across = (self.columns.index(x) + 0.5) * width / len(SECTORS_X)
        return left + across, top + (SECTORS_Y.index(y) + 0.5) * height / len(SECTORS_Y)

    @property
    def _grid(self) -> tuple[float, float, float, float]:
        left, top, width, height = self.rect
        return left + LABEL_WIDTH, top + LABEL_HEIGHT, width - LABEL_WIDTH, height - LABEL_HEIGHT

    def _sector(self, canvas: Canvas, place: Place, wide: float, high: float) -> None:
        x, y = self.center(place.x, place.y)
        cell = (x - wide / 2 + 1, y - high / 2 + 1, wide - 2, high - 2)
        rounded(canvas, cell, 5, between(CARD, ACCENT, 0.35))

    def _hand(self, canvas: Canvas) -> None:
        if self.place is None or self.place.contact:
            return
        x, y = self.center(self.place.x, self.place.y)
        canvas.disc(x, y, HAND_RADIUS + 1.5, CARD)
        canvas.disc(x, y, HAND_RADIUS, ACCENT)

    def _figure(self, canvas: Canvas) -> None:
        """Draw head, trunk and arms about the line between the two centres."""
        left, top, width, height = self._grid
        wide, high = width / len(SECTORS_X), height / len(SECTORS_Y)
        middle = left + wide * (1 if self.left_hand else len(SECTORS_X) - 1)
        canvas.disc(middle, top + 1.12 * high, 0.66 * high, FIGURE)
        trunk = (middle - 0.4 * wide, top + 2.05 * high, 0.8 * wide, height - 2.05 * high)
        rounded(canvas, trunk, 0.3 * wide, FIGURE)
        for side in (-1, 1):
            shoulder = [middle + side * 0.42 * wide, top + 2.45 * high]
            elbow = [middle + side * 0.68 * wide, top + 4.2 * high]
            wrist = [middle + side * 0.72 * wide, top + 5.6 * high]
            canvas.line([shoulder, elbow, wrist], FIGURE, 0.24 * wide)
