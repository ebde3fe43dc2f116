"""The time line: phases with borders to drag, and keys of hands, trunk and head."""

from dataclasses import dataclass

from imgui_bundle import imgui

from cubeling.app.ui.palette import HAPPY, INK, NEUTRAL, PAPER, QUIET, Color, between
from cubeling.app.ui.panels.drawing.style import pack_color
from cubeling.app.workshop.gesture_editor.editing import actions
from cubeling.app.workshop.gesture_editor.editing.document import ROWS, Row, keys_of
from cubeling.app.workshop.gesture_editor.editing.edits import MAX_REPEATS, Phase, move_key
from cubeling.app.workshop.gesture_editor.editing.state import EditorState
from cubeling.app.workshop.gesture_editor.editing.timing import (
    duration,
    moment_at,
    period,
    phase_at,
    phase_spans,
    time_line_span,
    time_of,
)
from cubeling.app.workshop.gesture_editor.editing.words import ROW_NAMES
from cubeling.app.workshop.gesture_editor.panels.ui import ACCENT, FIELD, SMALL, SUBTLE, Rect, Ui

LABEL_WIDTH, END_MARGIN = 106.0, 14.0
"""Room for the names of rows, and behind the last time [design units]."""

PHASE_HEIGHT, ROW_HEIGHT, ROW_GAP, PHASE_MARGIN = 28.0, 24.0, 3.0, 12.0
"""Heights of phases and rows, and the gaps below each and above the phases [design units]."""

REACH = 6.0
"""How far from a border of two phases the mouse takes it [design units]."""

NAME_GAP = 12.0
"""Between the name of a row and the row [design units]."""

KEY_RADIUS = 10.0
"""Of a key's disc [design units]."""

PHASE_COLORS: dict[Phase, Color] = {
    "preparation": between(PAPER, ACCENT, 0.30),
    "stroke": ACCENT,
    "hold": between(PAPER, NEUTRAL, 0.75),
    "retraction": between(PAPER, HAPPY, 0.40),
}
"""Colours of the phases."""


@dataclass(frozen=True)
class TimeAxis:
    """Where times are in the window."""

    left: float
    """Its left end [px]."""

    width: float
    """Its width [px]."""

    span: float
    """Seconds from its left to its right end [s]."""

    def x(self, time: float) -> float:
        """Return where a time is."""
        return self.left + time / self.span * self.width

    def time(self, x: float) -> float:
        """Return the time at a place, within the axis [s]."""
        return min(max((x - self.left) / self.width, 0.0), 1.0) * self.span

    @classmethod
    def of(cls, state: EditorState, left: float, width: float) -> "TimeAxis":
        """Return the axis; its span does not change while something is dragged on it."""
        document = state.document if state.grip is None else state.grip
        return cls(left, width, time_line_span(document.gesture))


def time_line(ui: Ui) -> None:
    """Draw what plays the preview, the phases, and the rows of keys."""
    _transport(ui)
    ui.space(PHASE_MARGIN)
    origin, unit = imgui.get_cursor_screen_pos(), ui.unit
    left = origin.x + LABEL_WIDTH * unit
    right = origin.x + imgui.get_content_region_avail().x - END_MARGIN * unit
    axis = TimeAxis.of(ui.state, left, right - left)
    top = origin.y
    _phases(ui, axis, (left, top, right - left, PHASE_HEIGHT * unit))
    below = top + (PHASE_HEIGHT + ROW_GAP) * unit
    for row in ROWS:
        rect = left, below, right - left, ROW_HEIGHT * unit
        _row(ui, axis, row, rect)
        below += (ROW_HEIGHT + ROW_GAP) * unit
    _handles(ui, axis, top)
    time = min(ui.state.time, duration(ui.state.document.gesture))
    x, canvas = axis.x(time), imgui.get_window_draw_list()
    for color, width in ((PAPER, 4.0), (INK, 1.8)):
        ends = (x, top - 4.0 * unit), (x, below - ROW_GAP * unit)
        canvas.add_line(*ends, pack_color(color), width * unit)


def _transport(ui: Ui) -> None:
    """Draw what plays the preview, repeats, and what adds keys."""
    state, gesture = ui.state, ui.state.document.gesture
    if ui.button("play", "Pause" if state.playing else "Play", 66.0, chosen=True):
        ui.do(actions.toggle_play)
    for name, label, count in (("back", "<", -1), ("step", ">", 1)):
        imgui.same_line(0.0, 4.0 * ui.unit)
        if ui.button(name, label, 32.0):
            ui.do(actions.frames(count))
    imgui.same_line(0.0, 14.0 * ui.unit)
    time = min(state.time, duration(gesture))
    words = f"{time:.2f} s of {duration(gesture):.2f} s, {phase_at(gesture, time)}"
    ui.label(words, SUBTLE)
    right = imgui.get_window_width() / ui.unit - 14.0
    imgui.same_line((right - 414.0) * ui.unit)
    ui.label("Repeats", SUBTLE)
    changes = (
        ("fewer", "-", -1, gesture.repeats > 1),
        ("more", "+", 1, gesture.repeats < MAX_REPEATS),
    )
    for name, label, more, enabled in changes:
        imgui.same_line(0.0, 8.0 * ui.unit)
        if ui.button(name, label, 28.0, enabled=enabled):
            ui.state = actions.repeat(ui.state, more)
        if name == "fewer":
            imgui.same_line(0.0, 8.0 * ui.unit)
            ui.label(f"{gesture.repeats}")
    buttons = (
        ("mirror", "Mirror", 64.0, actions.swap_sides, True),
        ("add key", "Add key", 78.0, actions.add, True),
        ("delete key", "Delete key", 94.0, actions.delete, actions.has_key(state.document)),
    )
    imgui.same_line((right - 64.0 - 78.0 - 94.0 - 12.0) * ui.unit)
    for name, label, width, action, enabled in buttons:
        if ui.button(name, label, width, enabled=enabled):
            ui.do(action)
        imgui.same_line(0.0, 6.0 * ui.unit)
    imgui.new_line()


def _phases(ui: Ui, axis: TimeAxis, rect: Rect) -> None:
    """Draw the bands of the phases; the mouse puts the preview to a time."""
    gesture = ui.state.document.gesture
    left, top, _, high = rect
    canvas, unit = imgui.get_window_draw_list(), ui.unit
    ui.write("Phases", (left - NAME_GAP * unit, top + high / 2), SUBTLE, SMALL, 1.0)
    imgui.set_cursor_screen_pos((left, top))
    imgui.set_next_item_allow_overlap()
    imgui.invisible_button("time", (rect[2], high))
    ui.note("time")
    if imgui.is_item_active():
        ui.state = actions.show_time(ui.state, axis.time(imgui.get_mouse_pos().x))
    for phase, (start, end) in phase_spans(gesture).items():
        ends = axis.x(start) + 0.5, min(axis.x(end), left + rect[2]) - 0.5
        if ends[1] - ends[0] < 1.0:
            continue
        band = (ends[0], top), (ends[1], top + high)
        canvas.add_rect_filled(*band, pack_color(PHASE_COLORS[phase]), 5.0 * unit)
        with ui.font(SMALL):
            words = _longest_fitting(phase, end - start, ends[1] - ends[0] - 18.0 * unit)
        place = ends[0] + 10.0 * unit, top + high / 2
        ui.write(words, place, PAPER if phase == "stroke" else INK, SMALL, 0.0)
    for number in range(1, gesture.repeats):
        x = axis.x(gesture.preparation + number * period(gesture))
        canvas.add_line((x, top + 3), (x, top + high - 3), pack_color(PAPER), 1.2 * unit)


def _longest_fitting(phase: str, length: float, room: float) -> str:
    """Return the longest of some names that fits."""
    seconds = f"{length:.2f}"
    for words in (f"{phase}  {seconds} s", f"{phase} {seconds}", phase, seconds, phase[0]):
        if imgui.calc_text_size(words).x <= room:
            return words
    return ""


def _handles(ui: Ui, axis: TimeAxis, top: float) -> None:
    """Draw the ends of the phases, and the apex; each is dragged."""
    gesture, unit = ui.state.document.gesture, ui.unit
    canvas, high = imgui.get_window_draw_list(), PHASE_HEIGHT * unit
    # Backwards: where two ends meet, Dear ImGui gives the mouse to the first, and a hold of no
    # length could not be made longer.
    for phase, (_, end) in reversed(phase_spans(gesture).items()):
        x = axis.x(end)
        rect = x - REACH * unit, top, 2 * REACH * unit, high
        strong = _grip(ui, f"end:{phase}", rect)
        if imgui.is_item_active():
            ui.state = actions.end_phase(ui.state, phase, axis.time(imgui.get_mouse_pos().x))
        ends = (x, top + 5 * unit), (x, top + high - 5 * unit)
        canvas.add_line(*ends, pack_color(PAPER), 6.0 * unit)
        canvas.add_line(*ends, pack_color(INK if strong else between(PAPER, INK, 0.55)), 3.0 * unit)
    x = axis.x(time_of(gesture, gesture.apex))
    strong = _grip(ui, "apex", (x - 8 * unit, top - 13 * unit, 16 * unit, 13 * unit))
    if imgui.is_item_active():
        ui.state = actions.put_apex(ui.state, axis.time(imgui.get_mouse_pos().x))
    corner = top - (12 if strong else 10) * unit
    canvas.add_triangle_filled(
        (x - 6.5 * unit, corner), (x + 6.5 * unit, corner), (x, top + unit), pack_color(INK)
    )


def _grip(ui: Ui, name: str, rect: Rect) -> bool:
    """Take the mouse in a place; return whether it is there."""
    imgui.set_cursor_screen_pos(rect[:2])
    imgui.invisible_button(name, rect[2:])
    ui.note(name)
    strong = imgui.is_item_hovered() or imgui.is_item_active()
    if strong:
        imgui.set_mouse_cursor(imgui.MouseCursor_.resize_ew)
    return strong


def _row(ui: Ui, axis: TimeAxis, row: Row, rect: Rect) -> None:
    """Draw a row and its keys; a click selects it."""
    document, unit = ui.state.document, ui.unit
    left, top, width, high = rect
    start = left - LABEL_WIDTH * unit
    imgui.set_cursor_screen_pos((start, top))
    imgui.set_next_item_allow_overlap()
    if imgui.invisible_button(f"row:{row}", (LABEL_WIDTH * unit + width, high)):
        ui.edit(document.select(row, document.index))
    ui.note(f"row:{row}")
    chosen, canvas = row == document.row, imgui.get_window_draw_list()
    canvas.add_rect_filled((left, top), (left + width, top + high), pack_color(FIELD), 5 * unit)
    begin, end = (axis.x(time_of(document.gesture, at)) for at in (0.0, 1.0))
    share = 0.2 if chosen else 0.12 if imgui.is_item_hovered() else 0.07
    color = pack_color(between(PAPER, ACCENT, share))
    canvas.add_rect_filled((begin, top), (end, top + high), color, 5 * unit)
    place = left - NAME_GAP * unit, top + high / 2
    ui.write(ROW_NAMES[row], place, INK if chosen else SUBTLE, SMALL, 1.0)
    for index in range(len(keys_of(document.gesture, row))):
        _key(ui, axis, row, index, top + high / 2)


def _key(ui: Ui, axis: TimeAxis, row: Row, index: int, y: float) -> None:
    """Draw a key; a press selects it, and a drag moves it in time."""
    document, radius = ui.state.document, KEY_RADIUS * ui.unit
    x = axis.x(time_of(document.gesture, keys_of(document.gesture, row)[index].at))
    imgui.set_cursor_screen_pos((x - radius, y - radius))
    imgui.invisible_button(f"key:{row}:{index}", (2 * radius, 2 * radius))
    ui.note(f"key:{row}:{index}")
    if imgui.is_item_activated():
        ui.state = actions.show_key(ui.state, document.select(row, index))
    elif imgui.is_item_active() and imgui.get_io().mouse_delta.x:
        at = moment_at(document.gesture, axis.time(imgui.get_mouse_pos().x))
        ui.state = actions.show_key(ui.state, move_key(document, at))
    canvas, chosen = imgui.get_window_draw_list(), (document.row, document.index) == (row, index)
    canvas.add_circle_filled((x, y), radius, pack_color(ACCENT if chosen else QUIET))
    fill = ACCENT if chosen else between(PAPER, ACCENT, 0.3 * imgui.is_item_hovered())
    canvas.add_circle_filled((x, y), radius - 1.5 * ui.unit, pack_color(fill))
    ui.write(f"{index + 1}", (x, y), PAPER if chosen else INK, 12.0, 0.5)
