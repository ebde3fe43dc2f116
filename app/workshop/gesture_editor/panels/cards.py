"""What may lie over the window: the library, a recording to import, questions, keys."""

from collections.abc import Callable

from imgui_bundle import ImVec2, imgui

from cubeling.app.counted import quantity
from cubeling.app.ui.palette import ANGRY
from cubeling.app.workshop.gesture_editor.editing import actions
from cubeling.app.workshop.gesture_editor.editing.state import (
    Action,
    CardName,
    EditorState,
    Open,
    Save,
    unless_unsaved,
    with_request,
)
from cubeling.app.workshop.gesture_editor.panels.ui import LARGE, SMALL, SUBTLE, Ui

TITLES: dict[CardName, str] = {
    "open": "Open a gesture",
    "import": "Import a gesture from a recording",
    "save as": "Save under a name",
    "replace": "There is a gesture {name} already",
    "unsaved": "{name} has changes that are not saved",
    "keys": "Keys",
}
"""What stands at the top of each card."""

LIBRARY_WIDTH, LIBRARY_HEIGHT, NAME_COLUMNS = 860.0, 400.0, 5
"""Size of the list of gestures [design units], and its columns."""

MESSAGE_WIDTH = 460.0
"""Width of what went wrong [design units]."""

KEYS = (
    ("Space", "play and pause"),
    (", and .", "one frame back and ahead"),
    ("Left, Right", "another key of the row"),
    ("Shift+Left, Shift+Right", "move the key in time"),
    ("Up, Down", "another row"),
    ("Ctrl and an arrow", "move the hand by a sector"),
    ("A, Delete", "add a key, delete it"),
    ("Ctrl+Z", "undo"),
    ("Ctrl+Y, Ctrl+Shift+Z", "redo"),
    ("Ctrl+S, Ctrl+Shift+S", "save, save as"),
    ("Ctrl+O, Ctrl+N, Ctrl+I", "open, new, import"),
    ("Ctrl and a click on a slider", "type its value"),
    ("F", "full screen, and back"),
    ("Esc", "close a card, then the window"),
)
"""The keys, for the card that lists them."""

CARD_FLAGS = (
    imgui.WindowFlags_.always_auto_resize
    | imgui.WindowFlags_.no_title_bar
    | imgui.WindowFlags_.no_move
    | imgui.WindowFlags_.no_saved_settings
)


class CardPanel:
    """Shows the card that the state asks for."""

    def __init__(self) -> None:
        self._open: CardName = ""

    def draw(self, ui: Ui) -> None:
        """Draw the card; Esc and a click beside it close it, Enter does what it is for."""
        card = ui.state.card
        if card != self._open:
            if self._open:
                imgui.internal.close_popup_to_level(0, True)
            if card:
                imgui.open_popup(f"###{card}")
            self._open = card
        if not card:
            return
        size = imgui.get_io().display_size
        imgui.set_next_window_pos((size.x / 2, size.y / 2), 0, (0.5, 0.5))
        imgui.push_style_var(imgui.StyleVar_.window_padding, ImVec2(24.0 * ui.unit, 20.0 * ui.unit))
        if imgui.begin_popup_modal(f"###{card}", None, CARD_FLAGS)[0]:
            name = ui.state.document.gesture.name or "The gesture"
            ui.label(TITLES[card].format(name=name), size=LARGE)
            ui.space(10.0)
            _CARDS[card](ui)
            if ui.state.alarming:
                imgui.push_text_wrap_pos(MESSAGE_WIDTH * ui.unit)
                ui.label(ui.state.message, ANGRY)
                imgui.pop_text_wrap_pos()
            if ui.state.card == card and not imgui.is_window_appearing():
                _leave(ui)
            imgui.end_popup()
        imgui.pop_style_var()


def _leave(ui: Ui) -> None:
    """Handle what closes a card."""
    beside = not imgui.is_window_hovered(
        imgui.HoveredFlags_.root_and_child_windows
        | imgui.HoveredFlags_.allow_when_blocked_by_active_item
    )
    if imgui.is_key_pressed(imgui.Key.escape, False) or (imgui.is_mouse_clicked(0) and beside):
        ui.do(actions.without_card)
    elif any(imgui.is_key_pressed(key, False) for key in (imgui.Key.enter, imgui.Key.keypad_enter)):
        ui.do(actions.CARD_ACTIONS.get(ui.state.card, lambda state: state))


def _library(ui: Ui) -> None:
    ui.card_field("find", "type a part of the name", 280.0, first=True)
    names = actions.found_names(ui.state)
    imgui.same_line(0.0, 14.0 * ui.unit)
    ui.label(quantity(len(names), "gesture"), SUBTLE, SMALL)
    ui.space(6.0)
    height = LIBRARY_HEIGHT * ui.unit
    if imgui.begin_child("names", (LIBRARY_WIDTH * ui.unit, height)):
        opened = (ui.state.saved.gesture.name,)
        options = [(name, name) for name in names]
        name = ui.choose("open", options, opened, LIBRARY_WIDTH - 14.0, NAME_COLUMNS)
        if name is not None:
            ui.state = unless_unsaved(ui.state, Open(name))
    imgui.end_child()


def _recording(ui: Ui) -> None:
    ui.label("Recording", SUBTLE, SMALL)
    hint = "a .bvh, .amc or .glb#CLIP file: type its name, or drop it"
    ui.card_field("recording", hint, 560.0, first=True)
    left, top = imgui.get_cursor_pos()
    ends = (("start", "From [s]", "0.0"), ("end", "To [s]", "to its end"))
    for number, (name, words, hint) in enumerate(ends):
        imgui.set_cursor_pos((left + number * 152.0 * ui.unit, top))
        imgui.begin_group()
        ui.label(words, SUBTLE, SMALL)
        ui.card_field(name, hint, 140.0)
        imgui.end_group()
    imgui.same_line(left + 450.0 * ui.unit)
    imgui.set_cursor_pos_y(top + imgui.get_item_rect_size().y - imgui.get_frame_height())
    named = bool(ui.state.text("recording").strip())
    if ui.button("read", "Import", 110.0, enabled=named, chosen=True):
        ui.do(actions.read_recording)


def _name(ui: Ui) -> None:
    ui.card_field("new name", "a name, such as WAVE", 320.0, first=True)
    imgui.same_line()
    named = bool(ui.state.text("new name").strip())
    if ui.button("save it", "Save", 90.0, enabled=named, chosen=True):
        ui.do(actions.save_under_name)


def _ask_name(state: EditorState) -> EditorState:
    return actions.with_card(state, "save as")


def _replace(state: EditorState) -> EditorState:
    return with_request(state, Save(overwrite=True))


def _question(*answers: tuple[str, Action]) -> Callable[[Ui], None]:
    """Return what draws answers side by side; the last one is suggested."""

    def draw(ui: Ui) -> None:
        for number, (label, action) in enumerate(answers):
            if number:
                imgui.same_line()
            suggested = number == len(answers) - 1
            if ui.button(f"answer:{label.lower()}", label, 140.0, chosen=suggested):
                ui.do(action)

    return draw


def _keys(ui: Ui) -> None:
    for keys, words in KEYS:
        ui.label(keys)
        imgui.same_line(224.0 * ui.unit)
        ui.label(words, SUBTLE)


_CARDS: dict[CardName, Callable[[Ui], None]] = {
    "open": _library,
    "import": _recording,
    "save as": _name,
    "replace": _question(
        ("Keep editing", actions.without_card),
        ("Another name", _ask_name),
        ("Replace it", _replace),
    ),
    "unsaved": _question(
        ("Keep editing", actions.without_card),
        ("Discard changes", actions.go_on),
        ("Save", actions.save_and_go_on),
    ),
    "keys": _keys,
}
"""What draws each card below its title."""
