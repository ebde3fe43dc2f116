"""What may lie over the window: the library, contacts, a recording to import, questions, keys."""

from collections.abc import Callable
from dataclasses import replace

from cubeling.app.counted import counted
from cubeling.app.gesture_editor.editing.edits import change_place, gesture_name
from cubeling.app.gesture_editor.editing.state import (
    Action,
    CardName,
    EditorState,
    Import,
    Open,
    Save,
    asked,
    committed,
    edited,
    told,
    unless_unsaved,
    with_text,
)
from cubeling.app.gesture_editor.panels.fields import TextField
from cubeling.app.gesture_editor.panels.widgets import (
    LARGE,
    NORMAL,
    SMALL,
    SUBTLE,
    Button,
    Label,
    Rect,
    Scrim,
    Sheet,
    Widget,
    button_row,
)
from cubeling.app.ui.palette import INK
from cubeling.characters.behaviour import CONTACTS

WIDTH, HEIGHT = 1280.0, 720.0
"""Of the window, in units of the canvas."""

MAX_NAMES, NAME_COLUMNS = 70, 5
"""Gestures that the card of the library shows, and in how many columns."""

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
    ("Ctrl+S", "save"),
    ("Ctrl+O, Ctrl+N", "open, new"),
    ("F", "full screen, and back"),
    ("Esc", "close a card, then the window"),
)
"""The keys, for the card that lists them."""


def card(state: EditorState) -> list[Widget]:
    """Return the widgets of the card that is open."""
    cards: dict[CardName, Callable[[EditorState], list[Widget]]] = {
        "open": _library,
        "contact": _contacts,
        "import": _recording,
        "save as": _name,
        "replace": _replace,
        "unsaved": _unsaved,
        "keys": _keys,
    }
    return cards[state.card](state) if state.card else []


def closed(state: EditorState) -> EditorState:
    """Close the card."""
    return replace(state, card="", wanted=None, focus="")


def enter(state: EditorState) -> EditorState:
    """Do what Enter does in a card."""
    action: dict[CardName, Action] = {
        "save as": _save_under_name,
        "import": _read_recording,
        "open": _open_first,
    }
    return action[state.card](state) if state.card in action else state


def found_names(state: EditorState) -> tuple[str, ...]:
    """Return the names that have what was typed in them."""
    wanted = state.text("find").strip().upper()
    return tuple(name for name in state.names if wanted in name.upper())


def _sheet(
    title: str, width: float, height: float, *, closable: bool = True
) -> tuple[list[Widget], float, float]:
    """Return a card with a title in the middle of the window, and its left and top edge."""
    left, top = (WIDTH - width) / 2, (HEIGHT - height) / 2
    edge: Rect = (left - 1.5, top - 1.5, width + 3, height + 3)
    widgets: list[Widget] = [
        Scrim("scrim", (0.0, 0.0, WIDTH, HEIGHT), closed),
        Sheet("edge", edge, INK, 19.5),
        Sheet("card", (left, top, width, height), radius=18, catches=True),
        Label("title", (left + 24, top + 38, width - 48 - 92 * closable, 0.0), title, LARGE),
    ]
    if closable:
        place: Rect = (left + width - 88, top + 16, 68.0, 28.0)
        widgets.append(Button("close", place, "Close", closed))
    return widgets, left, top


def _library(state: EditorState) -> list[Widget]:
    names = found_names(state)
    widgets, left, top = _sheet("Open a gesture", 900.0, 540.0)
    shown = tuple((name, name) for name in names[:MAX_NAMES])

    def choose(state: EditorState, name: str) -> EditorState:
        return unless_unsaved(state, Open(name))

    more = f"the first {MAX_NAMES}" if len(names) > MAX_NAMES else counted(len(names), "gesture")
    return [
        *widgets,
        TextField(
            "find", (left + 220, top + 16, 260.0, 28.0), state.text("find"),
            "type a part of the name", state.focus == "find",
        ),
        Label("count", (left + 494, top + 35, 200.0, 0.0), more, SMALL, SUBTLE),
        *button_row(
            "open", (left + 24, top + 62, 852.0, 28.0), shown, (state.saved.gesture.name,), choose,
            columns=NAME_COLUMNS,
        ),
    ]  # fmt: skip


def _open_first(state: EditorState) -> EditorState:
    names = found_names(state)
    return unless_unsaved(state, Open(names[0])) if names else state


def _contacts(state: EditorState) -> list[Widget]:
    widgets, left, top = _sheet("What the hand touches", 560.0, 268.0)
    key = state.document.hand_key
    options = (("", "nothing"), *((name, name) for name in CONTACTS))

    def choose(state: EditorState, name: str) -> EditorState:
        changed = edited(state, change_place(state.document, contact=name))
        return closed(changed)

    chosen = () if key is None else (key.place.contact,)
    rect: Rect = (left + 24, top + 62, 512.0, 30.0)
    return [*widgets, *button_row("touch", rect, options, chosen, choose, columns=4)]


def _recording(state: EditorState) -> list[Widget]:
    widgets, left, top = _sheet("Import a gesture from a recording", 620.0, 252.0)
    fields = (
        (
            "recording",
            left + 24,
            572.0,
            "a .bvh, .amc or .glb#CLIP file: type its name, or drop it",
        ),
        ("start", left + 24, 150.0, "0.0"),
        ("end", left + 190, 150.0, "to its end"),
    )
    tops = {"recording": top + 82, "start": top + 146, "end": top + 146}
    names = {"recording": "Recording", "start": "From [s]", "end": "To [s]"}
    for name, x, wide, hint in fields:
        y = tops[name]
        widgets.append(Label(f"{name} label", (x, y - 6, wide, 0.0), names[name], SMALL, SUBTLE))
        rect: Rect = (x, y, wide, 32.0)
        widgets.append(TextField(name, rect, state.text(name), hint, state.focus == name))
    return [
        *widgets,
        Button(
            "read", (left + 466, top + 200, 130.0, 32.0), "Import", _read_recording,
            primary=True, enabled=bool(state.text("recording").strip()),
        ),
    ]  # fmt: skip


def _read_recording(state: EditorState) -> EditorState:
    try:
        start, end = (
            float(state.text(name).strip().replace(",", ".") or usual)
            for name, usual in (("start", "0"), ("end", "inf"))
        )
    except ValueError:
        return told(state, "start and end are numbers of seconds, such as 2.5", alarming=True)
    if not state.text("recording").strip():
        return told(state, "name a recording first", alarming=True)
    return unless_unsaved(state, Import(state.text("recording").strip(), start, end))


def _name(state: EditorState) -> list[Widget]:
    widgets, left, top = _sheet("Save under a name", 480.0, 196.0)
    return [
        *widgets,
        TextField(
            "new name", (left + 24, top + 70, 432.0, 34.0), state.text("new name"),
            "a name, such as WAVE", state.focus == "new name",
        ),
        Button(
            "save it", (left + 346, top + 136, 110.0, 34.0), "Save", _save_under_name,
            primary=True, enabled=bool(state.text("new name").strip()),
        ),
    ]  # fmt: skip


def _save_under_name(state: EditorState) -> EditorState:
    name = gesture_name(state.text("new name"))
    if not name:
        return told(state, "a gesture needs a name", alarming=True)
    document = state.document
    renamed = edited(state, replace(document, gesture=replace(document.gesture, name=name)))
    return _go_on(asked(committed(state, renamed), Save()))


def _unsaved(state: EditorState) -> list[Widget]:
    name = state.document.gesture.name or "The gesture"

    def discard(state: EditorState) -> EditorState:
        return _go_on(replace(state, requests=()))

    def save(state: EditorState) -> EditorState:
        return _go_on(asked(state, Save())) if state.document.gesture.name else _named_first(state)

    return _question(
        f"{name} has changes that are not saved",
        (("Keep editing", closed), ("Discard changes", discard), ("Save", save)),
    )


def _replace(state: EditorState) -> list[Widget]:
    return _question(
        f"There is a gesture {state.document.gesture.name} already",
        (
            ("Keep editing", closed),
            ("Another name", _named_first),
            ("Replace it", lambda state: asked(state, Save(overwrite=True))),
        ),
    )


def _go_on(state: EditorState) -> EditorState:
    """Ask for what was put off."""
    wanted = state.wanted
    return state if wanted is None else asked(replace(state, wanted=None), wanted)


def _named_first(state: EditorState) -> EditorState:
    """Ask for a name to save under."""
    named = with_text(state, "new name", state.document.gesture.name)
    return replace(named, card="save as", focus="new name")


def _question(title: str, buttons: tuple[tuple[str, Action], ...]) -> list[Widget]:
    """Return a card with answers; the last one is suggested."""
    widgets, left, top = _sheet(title, 524.0, 150.0, closable=False)
    for place, (label, action) in enumerate(buttons):
        rect: Rect = (left + 24 + 162 * place, top + 84, 152.0, 36.0)
        primary = place == len(buttons) - 1
        widgets.append(Button(f"answer:{label.lower()}", rect, label, action, primary=primary))
    return widgets


def _keys(state: EditorState) -> list[Widget]:
    widgets, left, top = _sheet("Keys", 520.0, 84.0 + 28.0 * len(KEYS))
    for row, (key, words) in enumerate(KEYS):
        y = top + 82 + 28 * row
        widgets.append(Label(f"key {row}", (left + 24, y, 190.0, 0.0), key, NORMAL))
        widgets.append(Label(f"does {row}", (left + 220, y, 280.0, 0.0), words, NORMAL, SUBTLE))
    return widgets
