"""The panel at the right: the selected key, and how the gesture is performed."""

from typing import Any, Literal

from imgui_bundle import imgui

from cubeling.app.workshop.gesture_editor.editing import actions
from cubeling.app.workshop.gesture_editor.editing.document import GestureDocument, moves
from cubeling.app.workshop.gesture_editor.editing.edits import (
    change_direction,
    change_expressivity,
    change_gesture,
    change_key,
    change_place,
    hands_of,
    move_key,
    with_hands,
)
from cubeling.app.workshop.gesture_editor.editing.words import (
    DIRECTION_NAMES,
    PATH_NAMES,
    ROW_NAMES,
    combine,
)
from cubeling.app.workshop.gesture_editor.panels.space_map import space_map
from cubeling.app.workshop.gesture_editor.panels.ui import LARGE, SMALL, SUBTLE, Ui
from cubeling.characters.behaviour import (
    CONTACTS,
    NEUTRAL,
    SECTORS_Z,
    HandKey,
    without_effect,
)
from cubeling.characters.motion import HAND_SHAPES

WIDTH, COLUMN, GUTTER = 456.0, 220.0, 16.0
"""Width of the panel's content, of one of its two columns, and between them [design units]."""

LEFT = 14.0
"""Where the first column begins [design units]."""

MAP_HEIGHT = 244.0
"""Height of the map [design units]."""

LABEL_WIDTH = 62.0
"""Room for words before a row of buttons, as before the rows of the map [design units]."""

MAX_RADIUS, MAX_TURNS = 0.6, 8.0
"""Greatest amplitude of a path, over the length of the arm, and most turns."""

PARAMETERS = (
    ("spatial", "Extent", -1.0), ("openness", "Openness", 0.0), ("power", "Power", 0.0),
    ("fluidity", "Fluidity", -1.0), ("bias", "Bias", -1.0), ("tension", "Tension", -1.0),
)  # fmt: skip
"""Field of `GestureExpressivity`, its name, and its least value; the greatest is 1."""

BODY_LIMITS: dict[str, tuple[str, float]] = {
    "lean_deg": ("Lean forward", 45.0),
    "side_deg": ("Lean to its left", 30.0),
    "turn_deg": ("Turn to its left", 45.0),
    "shrug": ("Shrug", 1.0),
    "nod_deg": ("Head down", 45.0),
    "tilt_deg": ("Head to its left", 30.0),
    "shake_deg": ("Head turns left", 60.0),
}
"""Fields of `BodyKey` with their names and greatest values; the least is the opposite."""


def inspector(ui: Ui) -> None:
    """Draw the selected key, and below it what is true of the whole gesture."""
    document = ui.state.document
    _heading(ui, document)
    if document.row == "body":
        _body(ui, document)
    else:
        imgui.begin_group()
        _place(ui, document)
        imgui.end_group()
        with ui.column(LEFT + COLUMN + GUTTER):
            _hand(ui, document.hand_key)
        if document.hand_key is not None:
            _path(ui, document.hand_key)
    _gesture(ui)


def _heading(ui: Ui, document: GestureDocument) -> None:
    count, name = len(document.keys), ROW_NAMES[document.row]
    words = f"{name}: no key yet" if not count else f"{name}, key {document.index + 1} of {count}"
    ui.label(words, size=LARGE)
    if not actions.has_key(document):
        return
    with ui.column(LEFT + COLUMN + GUTTER):
        at = document.keys[document.index].at
        moved = ui.slider("at", "Time in stroke", at, (0.0, 1.0), COLUMN, step=0.01)
        if moved is not None:
            ui.edit(move_key(ui.state.document, moved))


def _body(ui: Ui, document: GestureDocument) -> None:
    """Draw the sliders of trunk, shoulders and head."""
    if document.body_key is None:
        ui.label("Add a key to lean, turn, shrug or nod with the stroke.", SUBTLE)
        return
    for name, (words, high) in BODY_LIMITS.items():
        degrees = name.endswith("_deg")
        value = ui.slider(
            name, words, getattr(document.body_key, name), (-high if degrees else 0.0, high), WIDTH,
            step=1.0 if degrees else 0.05, words="%.0f°" if degrees else "%.2f", label_width=140.0,
        )  # fmt: skip
        if value is not None:
            _change(ui, **{name: value})


def _place(ui: Ui, document: GestureDocument) -> None:
    """Draw the map, the distance from the body, and what the hand touches."""
    key = document.hand_key
    place = None if key is None else key.place
    sector = space_map(ui, place, COLUMN, MAP_HEIGHT, left=document.row == "left")
    if sector is not None:
        ui.edit(change_place(ui.state.document, x=sector[0], y=sector[1]))
    chosen = () if place is None or place.contact else (place.z,)
    depths = [(each, each[1:]) for each in SECTORS_Z]
    _side_label(ui, "Distance")
    imgui.begin_group()
    depth = ui.choose("z", depths, chosen, COLUMN - LABEL_WIDTH, 3)
    imgui.end_group()
    if depth is not None:
        ui.edit(change_place(ui.state.document, z=depth))
    _side_label(ui, "Touches")
    imgui.begin_disabled(place is None)
    imgui.set_next_item_width((COLUMN - LABEL_WIDTH) * ui.unit)
    touched = "" if place is None else place.contact
    with ui.font(SMALL):
        if imgui.begin_combo("##contact", touched or "nothing", imgui.ComboFlags_.height_large):
            for name in ("", *CONTACTS):
                if imgui.selectable(name or "nothing", name == touched)[0]:
                    ui.edit(change_place(ui.state.document, contact=name))
                ui.note(f"touch:{name}")
            imgui.end_combo()
        else:
            ui.note("contact")
    imgui.end_disabled()


def _side_label(ui: Ui, words: str) -> None:
    """Write what a row is about, before it."""
    x, y = imgui.get_cursor_pos()
    with ui.font(SMALL):
        imgui.align_text_to_frame_padding()
        ui.label(words, SUBTLE)
    imgui.same_line()
    imgui.set_cursor_pos((x + LABEL_WIDTH * ui.unit, y))


def _hand(ui: Ui, key: HandKey | None) -> None:
    """Draw the shape of the hand, and its two directions."""
    if key is None:
        ui.space(40.0)
        ui.label("Click a sector of the map:\nthe hand goes there.", SUBTLE)
        return
    ui.label("Hand shape", SUBTLE, SMALL)
    shapes = [(each, each) for each in HAND_SHAPES]
    shape = ui.choose("shape", shapes, (key.shape,), COLUMN, 3)
    if shape is not None:
        _change(ui, shape=shape)
    directions: tuple[tuple[Literal["palm", "fingers"], str], ...]
    directions = ("palm", "Palm faces"), ("fingers", "Fingers point")
    for field, words in directions:
        ui.space(12.0)
        ui.label(words, SUBTLE, SMALL)
        with ui.font(SMALL):
            hint = "Shift: two at once"
            imgui.same_line(COLUMN * ui.unit - imgui.calc_text_size(hint).x)
            ui.label(hint, SUBTLE, SMALL)
        present = str(getattr(key, field))
        chosen = ui.choose(field, DIRECTION_NAMES, tuple(present.split("-")), COLUMN, 3)
        if chosen is not None:
            direction = combine(present, chosen, added=imgui.get_io().key_shift)
            ui.edit(change_direction(ui.state.document, field, direction))


def _path(ui: Ui, key: HandKey) -> None:
    """Draw how the hand gets here from the key before."""
    ui.space(10.0)
    ui.label("Path to this key", SUBTLE, SMALL)
    path = ui.choose("path", PATH_NAMES, (key.path,), WIDTH, len(PATH_NAMES))
    if path is not None:
        ui.state = actions.choose_path(ui.state, path)
    imgui.begin_disabled(key.path in ("line", "keys"))  # they have no effect there
    limits = -MAX_RADIUS, MAX_RADIUS
    sliders = (
        ("turns", "Turns", key.turns, (0.0, MAX_TURNS), 0.5, "%.1f"),
        ("radius:0", "Outward", key.radius[0], limits, 0.01, "%.2f"),
        ("radius:1", "Up", key.radius[1], limits, 0.01, "%.2f"),
        ("radius:2", "Forward", key.radius[2], limits, 0.01, "%.2f"),
    )
    for number, (name, label, value, ends, step, words) in enumerate(sliders):
        if number % 2:
            imgui.same_line((LEFT + COLUMN + GUTTER) * ui.unit)
        moved = ui.slider(name, label, value, ends, COLUMN, step=step, words=words)
        if moved is None:
            continue
        if name == "turns":
            _change(ui, turns=moved)
        else:
            radius = [moved if axis == number - 1 else old for axis, old in enumerate(key.radius)]
            _change(ui, radius=tuple(radius))
    imgui.end_disabled()


def _gesture(ui: Ui) -> None:
    """Draw who performs the gesture, and its expressivity."""
    gesture = ui.state.document.gesture
    ui.space(12.0)
    imgui.separator()
    ui.space(12.0)
    ui.label("Expressivity", size=LARGE)
    imgui.same_line((LEFT + WIDTH - 76.0) * ui.unit)
    with ui.font(SMALL):
        if ui.button("neutral", "neutral", 76.0, enabled=gesture.expressivity != NEUTRAL):
            ui.edit(change_gesture(ui.state.document, expressivity=NEUTRAL))
    for number, (name, label, low) in enumerate(PARAMETERS):
        if number % 2:
            imgui.same_line((LEFT + COLUMN + GUTTER) * ui.unit)
        value = getattr(gesture.expressivity, name)
        moved = ui.slider(name, label, value, (low, 1.0), COLUMN)
        if moved is not None:
            ui.edit(change_expressivity(ui.state.document, name, moved))
    idle = without_effect(gesture)
    if idle and moves(gesture):
        words = ", ".join(label for name, label, _ in PARAMETERS if name in idle)
        ui.label(f"No effect here: {words}", SUBTLE, SMALL)
    ui.space(8.0)
    _side_label(ui, "Hands")
    imgui.begin_group()
    options = [(each, each) for each in ("right", "left", "both", "either")]
    who = ui.choose("hand", options, (hands_of(gesture),), WIDTH - LABEL_WIDTH, 4)
    imgui.end_group()
    if who is not None:
        ui.edit(with_hands(ui.state.document, who))


def _change(ui: Ui, **fields: Any) -> None:
    ui.edit(change_key(ui.state.document, **fields))
