"""The whole window: which widgets there are, and the picture of them."""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from cubeling.app.gesture_editor.editing.state import EditorState
from cubeling.app.gesture_editor.panels.bars import lower_bar, upper_bar
from cubeling.app.gesture_editor.panels.cards import HEIGHT, WIDTH, card
from cubeling.app.gesture_editor.panels.inspector import inspector
from cubeling.app.gesture_editor.panels.time_line import draw_playhead, time_line
from cubeling.app.gesture_editor.panels.time_line_parts import KeyMark
from cubeling.app.gesture_editor.panels.widgets import (
    CARD,
    SMALL,
    Label,
    Look,
    Rect,
    Sheet,
    Widget,
    rounded,
)
from cubeling.app.ui.canvas import Canvas, text_width
from cubeling.app.ui.palette import ANGRY, INK, PAPER, RULE, between

Picture = NDArray[np.uint8]

PREVIEW: Rect = (8.0, 54.0, 732.0, 500.0)
"""Where the character is."""

DESK = between(PAPER, RULE, 0.55)
"""Background of the window."""


def widgets_of(state: EditorState) -> list[Widget]:
    """Return the widgets, those that lie over others last."""
    return [
        Sheet("bar", (0.0, 0.0, WIDTH, 48.0), PAPER, 0.0),
        *upper_bar(state),
        Sheet("panel", (744.0, 54.0, 528.0, 500.0), PAPER, 12.0),
        *inspector(state),
        Sheet("below", (0.0, 558.0, WIDTH, HEIGHT - 558.0), PAPER, 0.0),
        *lower_bar(state),
        *time_line(state),
        *card(state),
    ]


def widget_at(state: EditorState, x: float, y: float) -> Widget | None:
    """Return the widget that the mouse would press at a place."""
    found = (each for each in reversed(widgets_of(state)) if each.takes_mouse)
    return next((each for each in found if each.contains(x, y)), None)


def widget_named(state: EditorState, name: str) -> Widget | None:
    """Return the widget of a name."""
    return next((each for each in widgets_of(state) if each.name == name), None)


def preview_size(scale: float) -> tuple[int, int]:
    """Return the size of the preview's picture for a scale of the window [px]."""
    return round(PREVIEW[2] * scale), round(PREVIEW[3] * scale)


class WindowDrawing:
    """Draws the window; what has not changed since the last picture is not drawn again."""

    def __init__(self) -> None:
        self._key: object = None
        self._still = Canvas(1.0, 1.0, 1.0)

    def draw(self, state: EditorState, preview: Picture, scale: float) -> Picture:
        """Return the picture of the window, (height, width, 3) BGR.

        Parameters
        ----------
        state
            What it shows.
        preview
            Picture of the character, of `preview_size`.
        scale
            Pixels for a unit of the canvas.
        """
        hovered = widget_at(state, *state.pointer)
        under = "" if hovered is None else hovered.name
        key = replace(state, time=0.0, pointer=(0.0, 0.0), requests=()), under, scale
        if key != self._key:
            self._key, self._still = key, _still_parts(state, under, scale)
        canvas = self._still.copy()
        canvas.picture(PREVIEW[0], PREVIEW[1], preview, 12.0)
        draw_playhead(canvas, state)
        for widget in time_line(state):
            if isinstance(widget, KeyMark):
                widget.draw(canvas, _look(widget, state, under))
        _message(canvas, state)
        for widget in card(state):
            widget.draw(canvas, _look(widget, state, under))
        return canvas.color


def _still_parts(state: EditorState, under: str, scale: float) -> Canvas:
    """Draw what does not change while the preview plays."""
    canvas = Canvas(WIDTH, HEIGHT, scale)
    canvas.color[:] = DESK
    for widget in widgets_of(replace(state, card="")):
        widget.draw(canvas, _look(widget, state, under))
    return canvas


def _look(widget: Widget, state: EditorState, under: str) -> Look:
    hovered = widget.name == under and state.held in ("", under)
    return Look(hovered, widget.name == state.held)


def _message(canvas: Canvas, state: EditorState) -> None:
    """Write what happened, over the upper edge of the preview."""
    if not state.message:
        return
    left, top, width, _ = PREVIEW
    room = width - 60
    wide = min(text_width(state.message, SMALL + 1), room)
    pill: Rect = (left + (width - wide) / 2 - 16, top + 10, wide + 32, 32.0)
    rounded(canvas, pill, 16, ANGRY if state.alarming else INK)
    label: Rect = (pill[0] + 16, pill[1] + 21, wide + 1, 0.0)
    Label("message", label, state.message, SMALL + 1, CARD, "middle").draw(canvas, Look())
