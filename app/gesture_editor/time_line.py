"""The time line: phases with borders to drag, and keys of hands, trunk and head."""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from app.gesture_editor.document import ROWS, GestureDocument, Row, keys_of
from app.gesture_editor.edits import Phase, change_gesture, change_phase, move_key
from app.gesture_editor.state import EditorState, edited
from app.gesture_editor.timing import (
    duration,
    moment_at,
    period,
    phase_at,
    phase_spans,
    stroke_for,
    time_line_span,
    time_of,
)
from app.gesture_editor.widgets import (
    ACCENT,
    CARD,
    SMALL,
    SUBTLE,
    Label,
    Look,
    Rect,
    Widget,
    rounded,
)
from app.ui.canvas import Canvas, text_width
from app.ui.palette import HAPPY, INK, NEUTRAL, PAPER, QUIET, RULE, Color, between

LEFT, RIGHT = 150.0, 1256.0
"""Where the time line starts and ends."""

PHASE_TOP, PHASE_HEIGHT = 604.0, 26.0
"""Where the phases are."""

ROW_TOPS: dict[Row, float] = {"right": 634.0, "left": 659.0, "body": 684.0}
ROW_HEIGHT = 24.0
"""Where the rows of keys are."""

ROW_NAMES: dict[Row, str] = {"right": "Right hand", "left": "Left hand", "body": "Trunk and head"}

PHASE_COLORS: dict[Phase, Color] = {
    "preparation": between(PAPER, ACCENT, 0.30),
    "stroke": ACCENT,
    "hold": between(PAPER, NEUTRAL, 0.75),
    "retraction": between(PAPER, HAPPY, 0.40),
}

NOW = (156.0, 581.0)
"""Where the time of the preview is written."""

BORDER_REACH = 6.0
"""How far from a border of two phases the mouse takes it."""

SNAP_S = 0.01
"""Times of phases are multiples of this [s]."""


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
    axis: TimeAxis

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
    change: Callable[[EditorState, float], EditorState]
    apex: bool = False

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
    chosen: bool
    stroke: tuple[float, float]

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
    index: int
    chosen: bool
    axis: TimeAxis

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


def time_line(state: EditorState) -> list[Widget]:
    """Return the widgets of the time line."""
    document = state.document
    gesture = document.gesture
    axis = time_axis(state)
    spans = phase_spans(gesture)
    stroke = axis.x(time_of(gesture, 0.0)), axis.x(time_of(gesture, 1.0))
    bounds: Rect = (LEFT, PHASE_TOP, RIGHT - LEFT, PHASE_HEIGHT)
    name: Rect = (8.0, PHASE_TOP + 18, LEFT - 20, 0.0)
    widgets: list[Widget] = [
        Label("phases", name, "Phases", SMALL, SUBTLE, "right"),
        Phases("time", bounds, document, axis),
        *(_border(axis, phase, span) for phase, span in spans.items()),
        _apex(axis, document),
    ]
    for row in ROWS:
        top = ROW_TOPS[row]
        place: Rect = (8.0, top, RIGHT - 8.0, ROW_HEIGHT)
        widgets.append(KeyRow(f"row:{row}", place, row, row == document.row, stroke))
        for index, key in enumerate(keys_of(gesture, row)):
            x = stroke[0] + key.at * (stroke[1] - stroke[0])
            chosen = row == document.row and index == document.index
            mark: Rect = (x - 12, top, 24.0, ROW_HEIGHT)
            widgets.append(KeyMark(f"key:{row}:{index}", mark, row, index, chosen, axis))
    return widgets


def time_axis(state: EditorState) -> TimeAxis:
    """Return the axis; it does not change while something is dragged on it."""
    document = state.document if state.grip is None else state.grip
    return TimeAxis(time_line_span(document.gesture))


def draw_playhead(canvas: Canvas, state: EditorState) -> None:
    """Draw where the preview is, over the time line, and write its time and phase."""
    gesture = state.document.gesture
    time = min(state.time, duration(gesture))
    words = f"{time:.2f} s of {duration(gesture):.2f} s, {phase_at(gesture, time)}"
    canvas.text(*NOW, words, SMALL, SUBTLE)
    x = time_axis(state).x(time)
    bottom = ROW_TOPS["body"] + ROW_HEIGHT
    canvas.line([[x, PHASE_TOP - 4], [x, bottom]], PAPER, 4)
    canvas.line([[x, PHASE_TOP - 4], [x, bottom]], INK, 1.8)


def _border(axis: TimeAxis, phase: Phase, span: tuple[float, float]) -> Handle:
    """Return the handle of a phase's end."""
    x = axis.x(span[1])
    rect: Rect = (x - BORDER_REACH, PHASE_TOP, 2 * BORDER_REACH, PHASE_HEIGHT)

    def change(state: EditorState, to: float) -> EditorState:
        document = state.document
        begin = phase_spans(document.gesture)[phase][0]
        length = axis.time(to) - begin
        if phase == "stroke":
            length = stroke_for(document.gesture, length)
        length = round(length / SNAP_S) * SNAP_S
        return edited(state, change_phase(document, phase, length))

    return Handle(f"end:{phase}", rect, x, change)


def _apex(axis: TimeAxis, document: GestureDocument) -> Handle:
    """Return the handle of the apex, above the stroke."""
    x = axis.x(time_of(document.gesture, document.gesture.apex))
    rect: Rect = (x - 8, PHASE_TOP - 12, 16.0, 13.0)

    def change(state: EditorState, to: float) -> EditorState:
        share = moment_at(state.document.gesture, axis.time(to))
        apex = round(min(max(share, 0.0), 1.0), 2)
        return edited(state, change_gesture(state.document, apex=apex))

    return Handle("apex", rect, x, change, apex=True)
