"""The time line: phases with borders to drag, and keys of hands, trunk and head."""

from cubeling.app.gesture_editor.editing.document import ROWS, GestureDocument, keys_of
from cubeling.app.gesture_editor.editing.edits import Phase, change_gesture, change_phase
from cubeling.app.gesture_editor.editing.state import EditorState, edited
from cubeling.app.gesture_editor.editing.timing import (
    duration,
    moment_at,
    phase_at,
    phase_spans,
    stroke_for,
    time_line_span,
    time_of,
)
from cubeling.app.gesture_editor.panels.time_line_parts import (
    LEFT,
    PHASE_HEIGHT,
    PHASE_TOP,
    RIGHT,
    ROW_HEIGHT,
    ROW_TOPS,
    Handle,
    KeyMark,
    KeyRow,
    Phases,
    TimeAxis,
)
from cubeling.app.gesture_editor.panels.widgets import SMALL, SUBTLE, Label, Rect, Widget
from cubeling.app.ui.canvas import Canvas
from cubeling.app.ui.palette import INK, PAPER

NOW = (156.0, 581.0)
"""Where the time of the preview is written."""

BORDER_REACH = 6.0
"""How far from a border of two phases the mouse takes it."""

SNAP_S = 0.01
"""Times of phases are multiples of this [s]."""


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
