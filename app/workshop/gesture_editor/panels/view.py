"""The whole window: where its parts are, and the keys."""

from dataclasses import dataclass

import moderngl
from imgui_bundle import imgui

from cubeling.app.ui.panels.drawing.style import load_fonts
from cubeling.app.workshop.gesture_editor.editing.actions import ACTIONS
from cubeling.app.workshop.gesture_editor.editing.state import with_message
from cubeling.app.workshop.gesture_editor.panels.cards import CardPanel
from cubeling.app.workshop.gesture_editor.panels.inspector import WIDTH, inspector
from cubeling.app.workshop.gesture_editor.panels.stage import StagePanel
from cubeling.app.workshop.gesture_editor.panels.time_line import time_line
from cubeling.app.workshop.gesture_editor.panels.ui import Rect, Ui, use_editor_style
from cubeling.app.workshop.gesture_editor.panels.upper_bar import upper_bar
from cubeling.app.workshop.gesture_editor.session import EditorSession

MIN_SIZE = 1240.0, 740.0
"""The least window in which a design unit is a pixel."""

BAR_HEIGHT, TIME_LINE_HEIGHT, GAP = 47.0, 182.0, 8.0
"""Heights of the upper bar and of the time line, and the gap between parts [design units]."""

TYPED_KEYS = "?,."
"""Keys that are known by what they type: they are elsewhere on other keyboards."""

REPEATED = imgui.InputFlags_.route_global | imgui.InputFlags_.repeat


@dataclass(frozen=True)
class Parts:
    """Where the parts of a window are [px]."""

    bar: Rect
    """Name, files and history."""

    stage: Rect
    """Where the character is seen."""

    inspector: Rect
    """Panel of the selected key."""

    time_line: Rect
    """Strip of the phases and keys."""

    @classmethod
    def of(cls, width: float, height: float, unit: float) -> "Parts":
        """Return the parts of a window; the character has what the others leave."""
        bar, gap = BAR_HEIGHT * unit, GAP * unit
        column = (WIDTH + 28.0 + GAP) * unit
        left, top = width - column, bar + 2 * gap
        low = height - TIME_LINE_HEIGHT * unit
        return cls(
            (gap, gap, width - 2 * gap, bar),
            (gap, top, left - 2 * gap, low - gap - top),
            (left, top, column - gap, height - top - gap),
            (gap, low, left - 2 * gap, height - low - gap),
        )


class EditorView:
    """Shows a session by Dear ImGui, whose context must stay until it is released.

    Parameters
    ----------
    session
        What it shows and changes.
    context
        Where pictures go; it is not released.
    """

    def __init__(self, session: EditorSession, context: moderngl.Context) -> None:
        self.session = session
        """What it shows."""
        self.places: dict[str, Rect] = {}
        """Where each widget was in the last frame [px]."""
        load_fonts()
        self._stage, self._card, self._unit = StagePanel(context), CardPanel(), 0.0

    def draw(self, unit: float) -> None:
        """Draw within a frame of Dear ImGui, and do what the user asks for.

        `unit` is the number of pixels of a design unit; it is less if the window is too small.
        """
        io = imgui.get_io()
        width, height = io.display_size
        unit = min(unit, width / MIN_SIZE[0], height / MIN_SIZE[1])
        if unit != self._unit:
            use_editor_style(unit)
            self._unit = unit
        ui, parts = Ui(self.session.state, unit), Parts.of(width, height, unit)
        if imgui.is_mouse_clicked(0):
            ui.state = with_message(ui.state, "")
        if not ui.state.card:
            _handle_keys(ui)
        with ui.part("bar", parts.bar):
            upper_bar(ui)
        with ui.part("inspector", parts.inspector):
            inspector(ui)
        with ui.part("time line", parts.time_line):
            time_line(ui)
        with ui.part("stage", parts.stage, 0.0):
            self._stage.draw(ui, self.session, parts.stage, io.display_framebuffer_scale.x)
        self._card.draw(ui)
        self.places = ui.places
        self.session.settle(ui.state, imgui.internal.get_active_id())

    def release(self) -> None:
        """Release what draws; a second call does nothing."""
        self._stage.release()


def chord_of(keys: str) -> list[imgui.Key]:
    """Return the keys of "Ctrl+Shift+Left", as Dear ImGui knows them."""
    names = {"Ctrl": "mod_ctrl", "Shift": "mod_shift"}
    names |= {arrow: f"{arrow.lower()}_arrow" for arrow in ("Left", "Right", "Up", "Down")}
    return [imgui.Key[names.get(key, key.lower())] for key in keys.split("+")]


_CHORDS = {
    keys: sum(int(key) for key in chord_of(keys)) for keys in ACTIONS if keys not in TYPED_KEYS
}
"""The keys that are known by their places, as numbers of Dear ImGui."""


def _handle_keys(ui: Ui) -> None:
    """Do what keys ask for, unless a text field takes them."""
    io = imgui.get_io()
    typed = [] if io.want_text_input else [chr(code) for code in io.input_queue_characters]
    for keys, action in ACTIONS.items():
        chord = _CHORDS.get(keys)
        if keys in typed if chord is None else imgui.shortcut(chord, REPEATED):
            imgui.internal.clear_active_id()
            if keys == "Escape" and imgui.is_popup_open("", imgui.PopupFlags_.any_popup):
                imgui.internal.close_popup_to_level(0, True)  # the list of what a hand touches
            else:
                ui.state = action(with_message(ui.state, ""))
