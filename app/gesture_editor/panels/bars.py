"""The bar at the top, and the one above the time line."""

from dataclasses import replace
from pathlib import Path

from cubeling.app.gesture_editor.editing.document import GestureDocument
from cubeling.app.gesture_editor.editing.edits import (
    MAX_REPEATS,
    add_key,
    change_gesture,
    mirror,
    performed_by,
    performers,
    remove_key,
)
from cubeling.app.gesture_editor.editing.state import (
    Action,
    EditorState,
    New,
    Save,
    asked,
    edited,
    redo,
    undo,
    unless_unsaved,
    with_text,
)
from cubeling.app.gesture_editor.editing.timing import duration, nearest_moment
from cubeling.app.gesture_editor.panels.fields import TextField
from cubeling.app.gesture_editor.panels.widgets import (
    SMALL,
    SUBTLE,
    Button,
    Label,
    Rect,
    Widget,
    button_row,
)

BUTTON_TOP, BUTTON_HEIGHT = 12.0, 30.0
"""Where the buttons of the upper bar are."""

LOWER_TOP, LOWER_HEIGHT = 563.0, 25.0
"""Where the buttons above the time line are."""

STEP_S = 1 / 30
"""How far a step moves the preview [s]."""

FIELDS = {"name": "NAME", "summary": "what it means"}
"""Text fields of the document, each with its hint."""


def upper_bar(state: EditorState) -> list[Widget]:
    """Return name, meaning, files, history, and who performs."""
    top, height = BUTTON_TOP, BUTTON_HEIGHT
    widgets: list[Widget] = [
        _field(state, "name", (12.0, top, 172.0, height)),
        _field(state, "summary", (190.0, top, 188.0, height)),
    ]
    left = 392.0
    buttons: tuple[tuple[str, float, Action, bool, bool], ...] = (
        ("New", 50.0, lambda state: unless_unsaved(state, New()), True, False),
        ("Open", 54.0, lambda state: with_card(state, "open"), True, False),
        ("Import", 62.0, lambda state: with_card(state, "import"), True, False),
        ("Save", 54.0, save, True, state.changed),
        ("Save as", 70.0, lambda state: with_card(state, "save as"), True, False),
        ("Undo", 54.0, undo, bool(state.past), False),
        ("Redo", 54.0, redo, bool(state.future), False),
        ("Mirror", 60.0, lambda state: edited(state, mirror(state.document)), True, False),
        ("Sectors", 68.0, toggle_sectors, True, False),
        ("?", 30.0, lambda state: with_card(state, "keys"), True, False),
    )
    for label, width, action, enabled, primary in buttons:
        rect: Rect = (left, top, width, height)
        chosen = label == "Sectors" and state.sectors_shown
        widgets.append(
            Button(label.lower(), rect, label, action, enabled, chosen=chosen, primary=primary)
        )
        left += width + (12.0 if label in ("Save as", "Redo", "Sectors") else 4.0)
    options = tuple((name, Path(name).stem) for name in state.characters)
    rect = (left + 8, top, 1268.0 - left - 8, height)
    return [*widgets, *button_row("character", rect, options, (state.character,), _with_character)]


def lower_bar(state: EditorState) -> list[Widget]:
    """Return what plays the preview, who performs the gesture, and what adds keys."""
    document, top, height = state.document, LOWER_TOP, LOWER_HEIGHT
    gesture = document.gesture
    played = "Pause" if state.playing else "Play"
    options = tuple((each, each) for each in ("right", "left", "both", "either"))
    return [
        Button("play", (12.0, top, 64.0, height), played, toggle_play, primary=True),
        Button("back", (82.0, top, 30.0, height), "<", lambda each: step(each, -1)),
        Button("step", (114.0, top, 30.0, height), ">", lambda each: step(each, 1)),
        Label("who", (410.0, top + 18, 90.0, 0.0), "Performed by", SMALL, SUBTLE),
        *button_row(
            "hand", (498.0, top, 236.0, height), options, (performers(gesture),),
            lambda state, value: edited(state, performed_by(state.document, value)),
        ),
        Label("times", (756.0, top + 18, 56.0, 0.0), "Repeats", SMALL, SUBTLE),
        Button("fewer", (812.0, top, 28.0, height), "-", lambda each: repeat(each, -1),
               enabled=gesture.repeats > 1),
        Label("repeats", (842.0, top + 18, 32.0, 0.0), f"{gesture.repeats}", align="middle"),
        Button("more", (876.0, top, 28.0, height), "+", lambda each: repeat(each, 1),
               enabled=gesture.repeats < MAX_REPEATS),
        Button("add key", (1064.0, top, 90.0, height), "Add key", add),
        Button("delete key", (1160.0, top, 104.0, height), "Delete key", delete,
               enabled=has_key(document)),
    ]  # fmt: skip


def with_card(state: EditorState, name: str) -> EditorState:
    """Open a card, with its first text field ready for what is typed."""
    first = {"open": "find", "import": "recording", "save as": "new name"}.get(name, "")
    state = replace(state, card=name, focus=first)  # type: ignore[arg-type]
    if name == "save as":
        state = with_text(state, "new name", state.document.gesture.name)
    return with_text(state, "find", "") if name == "open" else state


def save(state: EditorState) -> EditorState:
    """Save, or ask for a name first."""
    if not state.document.gesture.name.strip():
        return with_card(state, "save as")
    return asked(state, Save())


def toggle_play(state: EditorState) -> EditorState:
    """Pause the preview, or let it go on."""
    return replace(state, playing=not state.playing)


def toggle_sectors(state: EditorState) -> EditorState:
    """Show or hide the gesture space over the character."""
    return replace(state, sectors_shown=not state.sectors_shown)


def step(state: EditorState, frames: int) -> EditorState:
    """Move the preview by frames, and pause it."""
    time = min(max(state.time + frames * STEP_S, 0.0), duration(state.document.gesture))
    return replace(state, time=time, playing=False)


def repeat(state: EditorState, more: int) -> EditorState:
    """Perform the stroke more times."""
    repeats = state.document.gesture.repeats + more
    return edited(state, change_gesture(state.document, repeats=repeats))


def add(state: EditorState) -> EditorState:
    """Add a key where the preview is."""
    at = nearest_moment(state.document.gesture, state.time)
    return edited(state, add_key(state.document, at))


def delete(state: EditorState) -> EditorState:
    """Delete the selected key."""
    return edited(state, remove_key(state.document)) if has_key(state.document) else state


def has_key(document: GestureDocument) -> bool:
    """Return whether a key is selected."""
    return document.hand_key is not None or document.body_key is not None


def _with_character(state: EditorState, name: str) -> EditorState:
    return replace(state, character=name)


def _field(state: EditorState, name: str, rect: Rect) -> TextField:
    focused = state.focus == name
    text = state.text(name) if focused else getattr(state.document.gesture, name)
    return TextField(name, rect, text, FIELDS[name], focused)
