"""Events of mouse and keyboard: each takes the editor from one state to the next."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace

from cubeling.app.gesture_editor.editing.document import ROWS
from cubeling.app.gesture_editor.editing.edits import (
    change_gesture,
    gesture_name,
    move_key,
    move_sector,
    neighbour,
)
from cubeling.app.gesture_editor.editing.state import (
    Action,
    EditorState,
    New,
    Quit,
    committed,
    edited,
    redo,
    undo,
    unless_unsaved,
    with_text,
)
from cubeling.app.gesture_editor.panels import bars, cards
from cubeling.app.gesture_editor.panels.fields import TextField
from cubeling.app.gesture_editor.panels.layout import widget_at, widget_named
from cubeling.app.gesture_editor.panels.time_line_parts import key_shown

MAX_TEXT = 300
"""Letters that a text field takes."""

KEY_STEP = 0.02
"""How far an arrow moves a key, over the duration of the stroke."""


@dataclass(frozen=True)
class Moved:
    """The mouse is elsewhere."""

    x: float
    """In units of the canvas."""

    y: float
    """In units of the canvas."""


@dataclass(frozen=True)
class Pressed:
    """The left button of the mouse went down."""

    shift: bool = False
    """Whether Shift was held."""


@dataclass(frozen=True)
class Released:
    """The left button of the mouse went up."""


@dataclass(frozen=True)
class KeyPressed:
    """A key was pressed."""

    key: str
    """Its name: "Space", "←", "Z" …"""

    shift: bool = False
    """Whether Shift was held."""

    control: bool = False
    """Whether Ctrl, or ⌘, was held."""


@dataclass(frozen=True)
class Typed:
    """Letters were typed, or pasted."""

    text: str
    """The letters."""


@dataclass(frozen=True)
class Dropped:
    """A file was dropped on the window."""

    path: str
    """The file."""


Event = Moved | Pressed | Released | KeyPressed | Typed | Dropped


def handle(event: Event, state: EditorState) -> EditorState:
    """Return the state after an event."""
    handlers: dict[type, Callable[..., EditorState]] = {
        Moved: _move,
        Pressed: _press,
        Released: _release,
        KeyPressed: _key,
        Typed: _type,
        Dropped: _drop,
    }
    return handlers[type(event)](event, state)


def left_field(state: EditorState) -> EditorState:
    """Return the state after a text field is left: the document has its words."""
    name = state.focus
    if name not in bars.FIELDS:
        return replace(state, focus="") if name else state
    text = state.text(name).strip()
    text = gesture_name(text) if name == "name" else text
    document = change_gesture(state.document, **{name: text})
    return committed(state, replace(edited(state, document), focus=""))


def _move(event: Moved, state: EditorState) -> EditorState:
    state = replace(state, pointer=(event.x, event.y))
    widget = widget_named(state, state.held) if state.held else None
    return state if widget is None else widget.drag(state, event.x, event.y)


def _press(event: Pressed, state: EditorState) -> EditorState:
    widget = widget_at(state, *state.pointer)
    if not (isinstance(widget, TextField) and widget.name == state.focus):
        state = left_field(state)
    state = replace(state, message="", grip=state.document, shift=event.shift, held="")
    if widget is None:
        return state
    if isinstance(widget, TextField):
        return _focused(state, widget)
    return widget.press(replace(state, held=widget.name), *state.pointer)


def _release(event: Released, state: EditorState) -> EditorState:
    if state.grip is None:
        return state
    held, before = state.held, replace(state, document=state.grip)
    state = replace(committed(before, state), held="", grip=None)
    widget = widget_at(state, *state.pointer)
    if widget is None or widget.name != held:
        return state
    return committed(state, widget.click(state))


def _focused(state: EditorState, field: TextField) -> EditorState:
    """Let a text field take what is typed."""
    return with_text(replace(state, focus=field.name), field.name, field.text)


def _type(event: Typed, state: EditorState) -> EditorState:
    if not state.focus:
        return state
    letters = "".join(letter for letter in event.text if letter.isprintable())
    return with_text(state, state.focus, (state.text(state.focus) + letters)[:MAX_TEXT])


def _drop(event: Dropped, state: EditorState) -> EditorState:
    return with_text(bars.with_card(left_field(state), "import"), "recording", event.path)


def _key(event: KeyPressed, state: EditorState) -> EditorState:
    if state.focus and not event.control:
        return _key_in_field(event, state)
    state = replace(left_field(state), message="")
    if event.key == "Esc":
        return cards.closed(state) if state.card else unless_unsaved(state, Quit())
    if state.card:
        return cards.enter(state) if event.key == "Enter" else state
    action = _action(event)
    return state if action is None else committed(state, action(state))


def _key_in_field(event: KeyPressed, state: EditorState) -> EditorState:
    text = state.text(state.focus)
    if event.key == "Backspace":
        return with_text(state, state.focus, text[:-1])
    if event.key == "Enter":
        return cards.enter(state) if state.card else left_field(state)
    if event.key == "Esc":
        return cards.closed(state) if state.card else replace(state, focus="")
    return _next_field(state) if event.key == "Tab" else state


def _next_field(state: EditorState) -> EditorState:
    """Go on to the next text field of the same card."""
    fields = ("recording", "start", "end") if state.card == "import" else tuple(bars.FIELDS)
    if state.focus not in fields:
        return state
    following = fields[(fields.index(state.focus) + 1) % len(fields)]
    state = left_field(state)
    field = widget_named(state, following)
    return _focused(state, field) if isinstance(field, TextField) else state


def _action(event: KeyPressed) -> Action | None:
    """Return what a key does in the window itself."""
    with_shift = f"Shift {event.key}" if event.shift else event.key
    table = _WITH_CONTROL if event.control else _ALONE
    return table.get(with_shift) or table.get(event.key)


def _neighbour(step: int) -> Action:
    return lambda state: key_shown(state, neighbour(state.document, step))


def _row(step: int) -> Action:
    def select(state: EditorState) -> EditorState:
        place = min(max(ROWS.index(state.document.row) + step, 0), len(ROWS) - 1)
        return key_shown(state, state.document.select(ROWS[place], state.document.index))

    return select


def _in_time(step: float) -> Action:
    def move(state: EditorState) -> EditorState:
        document = state.document
        if not bars.has_key(document):
            return state
        at = document.keys[document.index].at + step
        return key_shown(state, move_key(document, at))

    return move


def _by_sector(right: int, down: int) -> Action:
    """Move the hand as it is seen on the map."""

    def move(state: EditorState) -> EditorState:
        outward = right if state.document.row == "left" else -right
        return edited(state, move_sector(state.document, outward, down))

    return move


_ALONE: Mapping[str, Action] = {
    "Space": bars.toggle_play,
    ",": lambda state: bars.step(state, -1),
    ".": lambda state: bars.step(state, 1),
    "←": _neighbour(-1),
    "→": _neighbour(1),
    "↑": _row(-1),
    "↓": _row(1),
    "A": bars.add,
    "Delete": bars.delete,
    "Backspace": bars.delete,
    "?": lambda state: bars.with_card(state, "keys"),
    "F1": lambda state: bars.with_card(state, "keys"),
    "Shift ←": _in_time(-KEY_STEP),
    "Shift →": _in_time(KEY_STEP),
}

_WITH_CONTROL: Mapping[str, Action] = {
    "Z": undo,
    "Shift Z": redo,
    "Y": redo,
    "S": bars.save,
    "Shift S": lambda state: bars.with_card(state, "save as"),
    "N": lambda state: unless_unsaved(state, New()),
    "O": lambda state: bars.with_card(state, "open"),
    "I": lambda state: bars.with_card(state, "import"),
    "←": _by_sector(-1, 0),
    "→": _by_sector(1, 0),
    "↑": _by_sector(0, -1),
    "↓": _by_sector(0, 1),
}
