"""Labels, sheets and buttons: pure, drawn on a canvas, events in, state out.

Every state makes new widgets. A widget is known by its name, so that it can be held.
"""

from collections.abc import Callable
from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from cubeling.app.gesture_editor.editing.state import Action, EditorState
from cubeling.app.ui.canvas import UNIT_CIRCLE, Canvas, text_width
from cubeling.app.ui.palette import ACTION_COLORS, INK, PAPER, QUIET, RULE, Color, between, bgr

Rect = tuple[float, float, float, float]
"""Left, top, width and height, in units of the canvas."""

ACCENT = ACTION_COLORS["walk"]
"""What is selected."""

CARD = bgr("#fffdf8")
"""Background of what can be changed."""

SUBTLE = bgr("#6d7385")
"""Words that explain; with a contrast of 4.5 to 1 on paper."""

SMALL, NORMAL, LARGE = 13.0, 14.5, 18.0
"""Sizes of text."""


@dataclass(frozen=True)
class Look:
    """How a widget is shown."""

    hovered: bool = False
    """Whether the mouse is on it."""

    held: bool = False
    """Whether it was pressed and not yet released."""


@dataclass(frozen=True)
class Widget:
    """Something on the canvas; this one is not seen and does nothing."""

    name: str
    """Tells it from the others."""

    rect: Rect
    """Where it is."""

    @property
    def takes_mouse(self) -> bool:
        """Whether the mouse can do something with it."""
        return False

    def contains(self, x: float, y: float) -> bool:
        """Return whether a place is on it."""
        left, top, width, height = self.rect
        return left <= x < left + width and top <= y < top + height

    def draw(self, canvas: Canvas, look: Look) -> None:
        """Draw it."""

    def press(self, state: EditorState, x: float, y: float) -> EditorState:
        """Handle the button of the mouse that goes down on it."""
        return state

    def drag(self, state: EditorState, x: float, y: float) -> EditorState:
        """Handle the mouse that moves while it is held."""
        return state

    def click(self, state: EditorState) -> EditorState:
        """Handle the button that is released on it."""
        return state


@dataclass(frozen=True)
class Label(Widget):
    """Words; (x, y) of the rectangle is the left end of the baseline, or another end of it."""

    words: str
    """What is written."""

    size: float = NORMAL
    """Of the letters, in units of the canvas."""

    color: Color = INK
    """Of the letters."""

    align: str = "left"
    """Which part of the words is at that part of the width: "left", "middle" or "right"."""

    def draw(self, canvas: Canvas, look: Look) -> None:
        """Write the words, smaller if they do not fit into the width."""
        left, y, width, _ = self.rect
        x = left + {"left": 0.0, "middle": 0.5, "right": 1.0}[self.align] * width
        canvas.text(x, y, self.words, fitting(self.words, self.size, width), self.color, self.align)


@dataclass(frozen=True)
class Sheet(Widget):
    """A background with round corners."""

    color: Color = PAPER
    """What it is filled with."""

    radius: float = 14.0
    """Of its corners, in units of the canvas."""

    catches: bool = False
    """Whether it keeps the mouse from what is below."""

    @property
    def takes_mouse(self) -> bool:
        """Whether it catches it."""
        return self.catches

    def draw(self, canvas: Canvas, look: Look) -> None:
        """Fill it."""
        rounded(canvas, self.rect, self.radius, self.color)


@dataclass(frozen=True)
class Scrim(Widget):
    """What darkens the window below a card; a click on it closes the card."""

    action: Action
    """Closes the card."""

    @property
    def takes_mouse(self) -> bool:
        """Always."""
        return True

    def draw(self, canvas: Canvas, look: Look) -> None:
        """Mix all that is drawn with ink."""
        ink = np.full_like(canvas.color, INK)
        canvas.color[:] = cv2.addWeighted(canvas.color, 0.6, ink, 0.4, 0.0)

    def click(self, state: EditorState) -> EditorState:
        """Close the card."""
        return self.action(state)


@dataclass(frozen=True)
class Button(Widget):
    """A button; it acts when it is released."""

    label: str
    """What is written on it."""

    action: Action
    """What it does."""

    enabled: bool = True
    """Whether it does it now."""

    chosen: bool = False
    """Whether it stands for what is chosen at present."""

    primary: bool = False
    """Whether it is what one probably wants."""

    size: float = NORMAL
    """Of the letters, in units of the canvas."""

    @property
    def takes_mouse(self) -> bool:
        """Whether it can be pressed; one that cannot still keeps the mouse from what is below."""
        return True

    def draw(self, canvas: Canvas, look: Look) -> None:
        """Draw it as a pill."""
        fill, ink = self._colors(look)
        left, top, width, height = self.rect
        radius = min(10.0, height / 2)
        filled = self.enabled and (self.chosen or self.primary)
        rounded(canvas, self.rect, radius, fill if filled else RULE)
        inner = (left + 1, top + 1, width - 2, height - 2)
        rounded(canvas, inner, radius - 1, fill)
        size = fitting(self.label, self.size, width - 10)
        canvas.text(
            left + width / 2, top + height / 2 + 0.36 * size, self.label, size, ink, "middle"
        )

    def click(self, state: EditorState) -> EditorState:
        """Act."""
        return self.action(state) if self.enabled else state

    def _colors(self, look: Look) -> tuple[Color, Color]:
        if not self.enabled:
            return PAPER, between(PAPER, QUIET, 0.6)
        if self.chosen or self.primary:
            return between(ACCENT, INK, 0.2 * (look.hovered + look.held)), PAPER
        return between(CARD, ACCENT, 0.14 * (look.hovered + look.held)), INK


def rounded(canvas: Canvas, rect: Rect, radius: float, color: Color) -> None:
    """Fill a rectangle with round corners."""
    canvas.fill(rounded_corners(rect, radius), color)


def rounded_corners(rect: Rect, radius: float) -> NDArray[np.float64]:
    """Return the outline of a rectangle with round corners, (n, 2)."""
    left, top, width, height = rect
    radius = max(min(radius, width / 2, height / 2), 0.0)
    corners = [
        (left + width - radius, top + height - radius),
        (left + radius, top + height - radius),
        (left + radius, top + radius),
        (left + width - radius, top + radius),
    ]
    closed = np.concatenate([UNIT_CIRCLE, UNIT_CIRCLE[:1]])
    quarter = len(UNIT_CIRCLE) // 4
    arcs = [
        np.array(corner) + radius * closed[number * quarter : (number + 1) * quarter + 1]
        for number, corner in enumerate(corners)
    ]
    return np.concatenate(arcs)


def fitting(words: str, size: float, width: float) -> float:
    """Return the size at which words fit into a width, at most `size`."""
    wide = text_width(words, size) if words else 0.0
    return size if wide <= width else size * width / wide


def button_row(
    prefix: str,
    rect: Rect,
    options: tuple[tuple[str, str], ...],
    chosen: tuple[str, ...],
    choose: Callable[[EditorState, str], EditorState],
    *,
    columns: int = 0,
    enabled: bool = True,
) -> list[Widget]:
    """Return buttons for (value, label) side by side, in rows of `columns`; one row if 0."""
    left, top, width, height = rect
    columns = columns or len(options)
    gap = 4.0
    wide = (width - gap * (columns - 1)) / columns
    return [
        Button(
            f"{prefix}:{value}",
            (
                left + (number % columns) * (wide + gap),
                top + (number // columns) * (height + gap),
                wide,
                height,
            ),
            label,
            lambda state, value=value: choose(state, value),  # type: ignore[misc]
            chosen=value in chosen,
            size=SMALL,
            enabled=enabled,
        )
        for number, (value, label) in enumerate(options)
    ]
