"""What buttons and keys do: each takes the editor from one state to the next."""

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from cubeling.app.workshop.gesture_editor.editing.document import ROWS, GestureDocument
from cubeling.app.workshop.gesture_editor.editing.edits import (
    Phase,
    add_key,
    change_gesture,
    change_key,
    change_phase,
    gesture_name,
    mirror,
    move_key,
    move_sector,
    neighbour,
    remove_key,
)
from cubeling.app.workshop.gesture_editor.editing.state import (
    Action,
    CardName,
    EditorState,
    Import,
    New,
    Open,
    Quit,
    Save,
    commit,
    redo,
    undo,
    unless_unsaved,
    with_document,
    with_message,
    with_request,
    with_text,
)
from cubeling.app.workshop.gesture_editor.editing.timing import (
    duration,
    moment_at,
    nearest_moment,
    phase_spans,
    stroke_for,
    time_of,
)

STEP_S = 1 / 30
"""How far a step moves the preview [s]."""

SNAP_S = 0.01
"""Times of phases are multiples of this [s]."""

KEY_STEP = 0.02
"""How far an arrow moves a key, over the duration of the stroke."""

FIRST_RADIUS = {"arc": (0.0, 0.15, 0.0), "circle": (0.15, 0.15, 0.0), "wave": (0.2, 0.0, 0.0)}
"""Radius of a path that was a line [lengths of the arm]; without one it would stay a line."""


def with_card(state: EditorState, name: CardName) -> EditorState:
    """Return the state with a card open over the panels."""
    if name == "save as":
        state = with_text(state, "new name", state.document.gesture.name)
    return replace(with_text(state, "find", ""), card=name)


def without_card(state: EditorState) -> EditorState:
    """Close the card, and forget what was to go on after it."""
    return replace(state, card="", wanted=None)


def leave(state: EditorState) -> EditorState:
    """Close the card, or the editor if there is none."""
    return without_card(state) if state.card else unless_unsaved(state, Quit())


def save(state: EditorState) -> EditorState:
    """Save, or ask for a name first."""
    if not state.document.gesture.name.strip():
        return with_card(state, "save as")
    return with_request(state, Save())


def save_under_name(state: EditorState) -> EditorState:
    """Save under the name that stands in the card, and go on with what was put off."""
    name = gesture_name(state.text("new name"))
    if not name:
        return with_message(state, "a gesture needs a name", alarming=True)
    renamed = with_document(state, change_gesture(state.document, name=name))
    return go_on(with_request(commit(state, renamed), Save()))


def save_and_go_on(state: EditorState) -> EditorState:
    """Save, ask for a name if there is none, and go on with what was put off."""
    return go_on(save(state)) if state.document.gesture.name else with_card(state, "save as")


def go_on(state: EditorState) -> EditorState:
    """Ask for what was put off."""
    wanted = state.wanted
    return state if wanted is None else with_request(replace(state, wanted=None), wanted)


def found_names(state: EditorState) -> tuple[str, ...]:
    """Return the gestures that have what was typed in their names."""
    wanted = state.text("find").strip().upper()
    return tuple(name for name in state.names if wanted in name.upper())


def open_first(state: EditorState) -> EditorState:
    """Open the first gesture that was found."""
    names = found_names(state)
    return unless_unsaved(state, Open(names[0])) if names else state


def read_recording(state: EditorState) -> EditorState:
    """Import what the card says."""
    try:
        start, end = (
            float(state.text(name).strip().replace(",", ".") or usual)
            for name, usual in (("start", "0"), ("end", "inf"))
        )
    except ValueError:
        return with_message(
            state, "start and end are numbers of seconds, such as 2.5", alarming=True
        )
    if not state.text("recording").strip():
        return with_message(state, "name a recording first", alarming=True)
    return unless_unsaved(state, Import(state.text("recording").strip(), start, end))


def drop_file(state: EditorState, path: str) -> EditorState:
    """Ask what to import of a file that was dropped on the window."""
    return with_text(with_card(state, "import"), "recording", path)


def toggle_play(state: EditorState) -> EditorState:
    """Pause the preview, or let it go on."""
    return replace(state, playing=not state.playing)


def show_time(state: EditorState, time: float) -> EditorState:
    """Put the preview to a time [s], and pause it."""
    time = min(max(time, 0.0), duration(state.document.gesture))
    return replace(state, time=time, playing=False)


def show_key(state: EditorState, document: GestureDocument) -> EditorState:
    """Return the state with another document, and the preview at its selected key."""
    if not has_key(document):
        return with_document(state, document)
    time = time_of(document.gesture, document.keys[document.index].at)
    return replace(state, document=document, time=time, playing=False)


def toggle_sectors(state: EditorState) -> EditorState:
    """Show or hide the gesture space over the character."""
    return replace(state, sectors_shown=not state.sectors_shown)


def choose_character(state: EditorState, name: str) -> EditorState:
    """Let another character perform the preview."""
    return replace(state, character=name)


def add(state: EditorState) -> EditorState:
    """Add a key where the preview is."""
    at = nearest_moment(state.document.gesture, state.time)
    return with_document(state, add_key(state.document, at))


def delete(state: EditorState) -> EditorState:
    """Delete the selected key."""
    return with_document(state, remove_key(state.document)) if has_key(state.document) else state


def has_key(document: GestureDocument) -> bool:
    """Return whether a key is selected."""
    return 0 <= document.index < len(document.keys)


def swap_sides(state: EditorState) -> EditorState:
    """Exchange left and right."""
    return with_document(state, mirror(state.document))


def choose_path(state: EditorState, path: str) -> EditorState:
    """Choose a path; one that would be a line gets a radius that can be seen."""
    key = state.document.hand_key
    changes: dict[str, Any] = {"path": path}
    if key is not None and path != "line" and not any(key.radius):
        changes["radius"] = FIRST_RADIUS.get(path, FIRST_RADIUS["arc"])
    return with_document(state, change_key(state.document, **changes))


def _card(name: CardName) -> Action:
    return lambda state: with_card(state, name)


def frames(count: int) -> Action:
    """Return what moves the preview by frames."""
    return lambda state: show_time(state, state.time + count * STEP_S)


def end_phase(state: EditorState, phase: Phase, time: float) -> EditorState:
    """Let a phase end at a time [s], in steps of `SNAP_S`."""
    gesture = state.document.gesture
    length = time - phase_spans(gesture)[phase][0]
    if phase == "stroke":
        length = stroke_for(gesture, length)
    length = round(length / SNAP_S) * SNAP_S
    return with_document(state, change_phase(state.document, phase, length))


def put_apex(state: EditorState, time: float) -> EditorState:
    """Put the apex of the stroke to a time [s]."""
    share = moment_at(state.document.gesture, time)
    apex = round(min(max(share, 0.0), 1.0), 2)
    return with_document(state, change_gesture(state.document, apex=apex))


def repeat(state: EditorState, more: int) -> EditorState:
    """Perform the stroke more times."""
    repeats = state.document.gesture.repeats + more
    return with_document(state, change_gesture(state.document, repeats=repeats))


def _neighbour(step: int) -> Action:
    return lambda state: show_key(state, neighbour(state.document, step))


def _row(step: int) -> Action:
    def select(state: EditorState) -> EditorState:
        place = min(max(ROWS.index(state.document.row) + step, 0), len(ROWS) - 1)
        return show_key(state, state.document.select(ROWS[place], state.document.index))

    return select


def _in_time(step: float) -> Action:
    def move(state: EditorState) -> EditorState:
        document = state.document
        if not has_key(document):
            return state
        at = document.keys[document.index].at + step
        return show_key(state, move_key(document, at))

    return move


def _by_sector(right: int, down: int) -> Action:
    """Move the hand as it is seen on the map."""

    def move(state: EditorState) -> EditorState:
        outward = right if state.document.row == "left" else -right
        return with_document(state, move_sector(state.document, outward, down))

    return move


ACTIONS: Mapping[str, Action] = {
    "Space": toggle_play,
    ",": frames(-1),
    ".": frames(1),
    "Left": _neighbour(-1),
    "Right": _neighbour(1),
    "Up": _row(-1),
    "Down": _row(1),
    "A": add,
    "Delete": delete,
    "Backspace": delete,
    "?": _card("keys"),
    "F1": _card("keys"),
    "Escape": leave,
    "Shift+Left": _in_time(-KEY_STEP),
    "Shift+Right": _in_time(KEY_STEP),
    "Ctrl+Z": undo,
    "Ctrl+Shift+Z": redo,
    "Ctrl+Y": redo,
    "Ctrl+S": save,
    "Ctrl+Shift+S": _card("save as"),
    "Ctrl+N": lambda state: unless_unsaved(state, New()),
    "Ctrl+O": _card("open"),
    "Ctrl+I": _card("import"),
    "Ctrl+Left": _by_sector(-1, 0),
    "Ctrl+Right": _by_sector(1, 0),
    "Ctrl+Up": _by_sector(0, -1),
    "Ctrl+Down": _by_sector(0, 1),
}
"""What keys do while no card is open."""

CARD_ACTIONS: Mapping[CardName, Action] = {
    "save as": save_under_name,
    "import": read_recording,
    "open": open_first,
}
"""What Enter does in a card."""
