"""What the time line is made of: an axis, phases, handles, rows and keys."""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from cubeling.app.gesture_editor.editing.document import GestureDocument, Row
from cubeling.app.gesture_editor.editing.edits import Phase, move_key
from cubeling.app.gesture_editor.editing.state import EditorState, edited
from cubeling.app.gesture_editor.editing.timing import (
    duration,
    moment_at,
    period,
    phase_spans,
    time_of,
)
from cubeling.app.gesture_editor.panels.widgets import (
    ACCENT,
    CARD,
    SMALL,
    SUBTLE,
    Look,
    Widget,
    rounded,
)
from cubeling.app.ui.canvas import Canvas, text_width
from cubeling.app.ui.palette import HAPPY, INK, NEUTRAL, PAPER, QUIET, RULE, Color, between

LEFT, RIGHT = 150.0, 1256.0
"""Where the time line starts and ends."""

PHASE_TOP, PHASE_HEIGHT = 604.0, 26.0
"""Where the phases are."""

ROW_TOPS: dict[Row, float] = {"right": 634.0, "left": 659.0, "body": 684.0}
"""Where each row of keys begins."""

ROW_HEIGHT = 24.0
"""Height of a row of keys."""

ROW_NAMES: dict[Row, str] = {"right": "Right hand", "left": "Left hand", "body": "Trunk and head"}
"""What each row is called."""

PHASE_COLORS: dict[Phase, Color] = {
    "preparation": between(PAPER, ACCENT, 0.30),
    "stroke": ACCENT,
    "hold": between(PAPER, NEUTRAL, 0.75),
    "retraction": between(PAPER, HAPPY, 0.40),
}
"""Colours of the phases."""


@dataclass(frozen=True)
class TimeAxis:
    """Where times are on the canvas."""

    span: float
    """Seconds from its left to its right end [s]."""

    def x(self, time: float) -> float:
        """Return where a time is."""
        return LEFT + time / self.span * (RIGHT - LEFT)

    def time(self, x: float) -> float:
        """Return the time at a place, within the axis [s]."""
        return min(max((x - LEFT) / (RIGHT - LEFT), 0.0), 1.0) * self.span


@dataclass(frozen=True)
class Phases(Widget):
    """The bands of the phases; the mouse puts the preview to a time."""

    document: GestureDocument
    """Whose phases they are."""

    axis: TimeAxis
    """Where times are."""

    @property
    def takes_mouse(self) -> bool:
        """Always."""
        return True

    def draw(self, canvas: Canvas, look: Look) -> None:
        """Draw the bands with their names and lengths."""
        for phase, (start, end) in phase_spans(self.document.gesture).items():
            left, right = self.axis.x(start), min(self.axis.x(end), RIGHT)
            if right - left < 1.0:
                continue
            band = (left + 0.5, PHASE_TOP, right - left - 1.0, PHASE_HEIGHT)
            rounded(canvas, band, 5, PHASE_COLORS[phase])
            ink = PAPER if phase == "stroke" else INK
            self._name(canvas, phase, end - start, (left, right), ink)
        gesture = self.document.gesture
        for number in range(1, gesture.repeats):
            x = self.axis.x(gesture.preparation + number * period(gesture))
            canvas.line([[x, PHASE_TOP + 3], [x, PHASE_TOP + PHASE_HEIGHT - 3]], PAPER, 1.2)

    def press(self, state: EditorState, x: float, y: float) -> EditorState:
        """Put the preview to the time under the mouse."""
        return self.drag(state, x, y)

    def drag(self, state: EditorState, x: float, y: float) -> EditorState:
        """Put the preview to the time under the mouse."""
        time = min(self.axis.time(x), duration(state.document.gesture))
        return replace(state, time=time, playing=False)

    @staticmethod
    def _name(
        canvas: Canvas, phase: str, length: float, ends: tuple[float, float], ink: Color
    ) -> None:
        """Write the longest of some names that fits."""
        room = ends[1] - ends[0] - 12
        seconds = f"{length:.2f}"
        for words in (f"{phase}  {seconds} s", f"{phase} {seconds}", phase, seconds, phase[0]):
            if text_width(words, SMALL) <= room:
                y = PHASE_TOP + PHASE_HEIGHT / 2 + 5
                canvas.text((ends[0] + ends[1]) / 2, y, words, SMALL, ink, "middle")
                return


@dataclass(frozen=True)
class Handle(Widget):
    """The end of a phase, or the apex, to be dragged."""

    x: float
    """Where it is drawn."""

    change: Callable[[EditorState, float], EditorState]
    """Moves it to another x."""

    apex: bool = False
    """Whether it is the apex."""

    @property
    def takes_mouse(self) -> bool:
        """Always."""
        return True

    def draw(self, canvas: Canvas, look: Look) -> None:
        """Draw a grip, or a triangle for the apex."""
        strong = look.hovered or look.held
        if self.apex:
            top = PHASE_TOP - (11 if strong else 9)
            triangle = np.array([[-6.0, top], [6.0, top], [0.0, PHASE_TOP + 1]])
            canvas.fill(triangle + (self.x, 0.0), INK)
            return
        color = INK if strong else between(PAPER, INK, 0.55)
        ends = [[self.x, PHASE_TOP + 4], [self.x, PHASE_TOP + PHASE_HEIGHT - 4]]
        canvas.line(ends, PAPER, 7)
        canvas.line(ends, color, 3.5)

    def drag(self, state: EditorState, x: float, y: float) -> EditorState:
        """Move it."""
        return self.change(state, x)


@dataclass(frozen=True)
class KeyRow(Widget):
    """The background of a row of keys; a click selects the row."""

    row: Row
    """Which one."""

    chosen: bool
    """Whether it is selected."""

    stroke: tuple[float, float]
    """Where the first stroke begins and ends."""

    @property
    def takes_mouse(self) -> bool:
        """Always."""
        return True

    def draw(self, canvas: Canvas, look: Look) -> None:
        """Draw the part of the stroke, in which keys may be."""
        _, top, _, height = self.rect
        color = between(PAPER, ACCENT, 0.16 if self.chosen else 0.05 * (1 + look.hovered))
        rounded(canvas, (LEFT, top, RIGHT - LEFT, height), 5, between(PAPER, RULE, 0.35))
        left, right = self.stroke
        rounded(canvas, (left, top, right - left, height), 5, color)
        ink = INK if self.chosen else SUBTLE
        canvas.text(LEFT - 12, top + height / 2 + 5, ROW_NAMES[self.row], SMALL, ink, "right")

    def click(self, state: EditorState) -> EditorState:
        """Select the row."""
        document = state.document
        return edited(state, document.select(self.row, document.index))


@dataclass(frozen=True)
class KeyMark(Widget):
    """A key, to be selected and dragged."""

    row: Row
    """Of which row."""

    index: int
    """Its number in the row."""

    chosen: bool
    """Whether it is selected."""

    axis: TimeAxis
    """Where times are."""

    @property
    def takes_mouse(self) -> bool:
        """Always."""
        return True

    def draw(self, canvas: Canvas, look: Look) -> None:
        """Draw a disc with its number."""
        left, top, width, height = self.rect
        x, y = left + width / 2, top + height / 2
        canvas.disc(x, y, 10.5, ACCENT if self.chosen else QUIET)
        fill = ACCENT if self.chosen else between(CARD, ACCENT, 0.3 * look.hovered)
        canvas.disc(x, y, 9.0, fill)
        ink = PAPER if self.chosen else INK
        canvas.text(x, y + 4.5, f"{self.index + 1}", 12.0, ink, "middle")

    def press(self, state: EditorState, x: float, y: float) -> EditorState:
        """Select it, and let the preview show it."""
        return key_shown(state, state.document.select(self.row, self.index))

    def drag(self, state: EditorState, x: float, y: float) -> EditorState:
        """Move it in time, once the mouse has left its place."""
        gesture = state.document.gesture
        document = move_key(state.document, moment_at(gesture, self.axis.time(x)))
        if document is state.document:
            return state
        return key_shown(state, document)


def key_shown(state: EditorState, document: GestureDocument) -> EditorState:
    """Return the state with another document, and the preview at its selected key."""
    if document.index >= len(document.keys):
        return edited(state, document)
    time = time_of(document.gesture, document.keys[document.index].at)
    return replace(state, document=document, time=time, playing=False)
