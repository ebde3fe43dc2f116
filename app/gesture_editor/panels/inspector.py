"""The panel at the right: the selected key, and how the gesture is performed."""

from dataclasses import replace
from typing import Any

from cubeling.app.gesture_editor.editing.document import GestureDocument
from cubeling.app.gesture_editor.editing.edits import change_key, change_place, move_key
from cubeling.app.gesture_editor.editing.state import EditorState, edited
from cubeling.app.gesture_editor.editing.words import DIRECTION_NAMES, PATH_NAMES, combined
from cubeling.app.gesture_editor.panels.body_panel import (
    BUTTON_PX,
    COLUMN,
    LEFT,
    MIDDLE,
    RIGHT,
    body_sliders,
    expressivity_sliders,
)
from cubeling.app.gesture_editor.panels.fields import Slider
from cubeling.app.gesture_editor.panels.space_map import SpaceMap
from cubeling.app.gesture_editor.panels.time_line_parts import ROW_NAMES
from cubeling.app.gesture_editor.panels.widgets import (
    LARGE,
    NORMAL,
    SMALL,
    SUBTLE,
    Button,
    Label,
    Rect,
    Widget,
    button_row,
)
from cubeling.characters.behaviour import SECTORS_Z, HandKey
from cubeling.characters.motion import HAND_SHAPES

MAX_RADIUS, MAX_TURNS = 0.6, 8.0
"""Greatest amplitude of a path, over the length of the arm, and most turns."""


def inspector(state: EditorState) -> list[Widget]:
    """Return the widgets of the panel."""
    document = state.document
    if document.body_key is not None:
        widgets = body_sliders(document.body_key)
    elif document.row == "body":
        words = ("Add a key to lean, turn,", "shrug or nod with the stroke.")
        widgets = _hint(LEFT, words)
    else:
        widgets = [*_place(document), *_shape(document)]
    return [*_heading(document), *widgets, *expressivity_sliders(document.gesture.expressivity)]


def _heading(document: GestureDocument) -> list[Widget]:
    count, name = len(document.keys), ROW_NAMES[document.row]
    words = f"{name}: no key yet" if not count else f"{name}, key {document.index + 1} of {count}"
    widgets: list[Widget] = [Label("heading", (LEFT, 84.0, 250.0, 0.0), words, LARGE)]
    if count:
        at = document.keys[min(document.index, count - 1)].at
        widgets.append(
            Slider(
                "at",
                (MIDDLE, 66.0, COLUMN, BUTTON_PX),
                "Time in stroke",
                at,
                0.0,
                1.0,
                lambda state, value: edited(state, move_key(state.document, value)),
                step=0.01,
                label_width=96.0,
            )
        )
    return widgets


def _place(document: GestureDocument) -> list[Widget]:
    """Return the map, the distance from the body, and what the hand touches."""
    key, left = document.hand_key, document.row == "left"
    place = None if key is None else key.place
    chosen = () if place is None or place.contact else (place.z,)
    touched = "nothing" if place is None or not place.contact else place.contact
    wide = MIDDLE - 16 - LEFT

    def to_sector(state: EditorState, x: str, y: str) -> EditorState:
        return edited(state, change_place(state.document, x=x, y=y))

    def to_depth(state: EditorState, z: str) -> EditorState:
        return edited(state, change_place(state.document, z=z))

    options = tuple((each, each[1:]) for each in SECTORS_Z)
    return [
        SpaceMap("map", (LEFT, 94.0, wide, 218.0), place, left, to_sector),
        Label("z", (LEFT, 337.0, 56.0, 0.0), "Distance", SMALL, SUBTLE),
        *button_row("z", (LEFT + 62, 320.0, wide - 62, BUTTON_PX), options, chosen, to_depth),
        Label("touches", (LEFT, 365.0, 56.0, 0.0), "Touches", SMALL, SUBTLE),
        Button(
            "contact",
            (LEFT + 62, 348.0, wide - 62, BUTTON_PX),
            touched,
            lambda state: replace(state, card="contact"),
            enabled=key is not None,
            chosen=touched != "nothing",
            size=SMALL,
        ),
    ]


def _shape(document: GestureDocument) -> list[Widget]:
    """Return the shape of the hand, its directions, and the path to it."""
    key = document.hand_key
    if key is None:
        return _hint(MIDDLE, ("Click a sector of the map:", "the hand goes there."))
    shapes = tuple((each, each) for each in HAND_SHAPES)
    widgets: list[Widget] = [
        Label("shape", (MIDDLE, 108.0, COLUMN, 0.0), "Hand shape", SMALL, SUBTLE),
        *button_row(
            "shape",
            (MIDDLE, 114.0, COLUMN, BUTTON_PX),
            shapes,
            (key.shape,),
            lambda state, value: _changed(state, shape=value),
            columns=4,
        ),
    ]
    for field, words, top in (("palm", "Palm faces", 210.0), ("fingers", "Fingers point", 288.0)):
        widgets += _directions(field, words, top, key)
    return [*widgets, *_path(key)]


def _directions(field: str, words: str, top: float, key: HandKey) -> list[Widget]:
    """Return the six directions; with Shift, two of them are combined."""

    def choose(state: EditorState, value: str) -> EditorState:
        present = state.document.hand_key
        old = "" if present is None else str(getattr(present, field))
        return _changed(state, **{field: combined(old, value, added=state.shift)})

    rect: Rect = (MIDDLE, top + 6, COLUMN, BUTTON_PX)
    chosen = tuple(str(getattr(key, field)).split("-"))
    return [
        Label(f"{field} label", (MIDDLE, top, COLUMN, 0.0), words, SMALL, SUBTLE),
        Label(
            f"{field} shift",
            (MIDDLE, top, COLUMN, 0.0),
            "Shift: two at once",
            12.0,
            SUBTLE,
            "right",
        ),
        *button_row(field, rect, DIRECTION_NAMES, chosen, choose, columns=3),
    ]


def _path(key: HandKey) -> list[Widget]:
    """Return how the hand gets here from the key before."""

    def radius(axis: int) -> Any:
        def change(state: EditorState, value: float) -> EditorState:
            present = state.document.hand_key
            new = list((0.0, 0.0, 0.0) if present is None else present.radius)
            new[axis] = value
            return _changed(state, radius=tuple(new))

        return change

    wide = (RIGHT - LEFT - 62 - 24) / 3
    widgets: list[Widget] = [
        Label("path", (LEFT, 397.0, 56.0, 0.0), "Path here", SMALL, SUBTLE),
        *button_row(
            "path",
            (LEFT + 62, 380.0, 246.0, BUTTON_PX),
            PATH_NAMES,
            (key.path,),
            _with_path,
        ),
        Slider(
            "turns",
            (LEFT + 326, 380.0, RIGHT - LEFT - 326, BUTTON_PX),
            "Turns",
            key.turns,
            0.0,
            MAX_TURNS,
            lambda state, value: _changed(state, turns=value),
            step=0.5,
            label_width=40.0,
            value_width=28.0,
        ),
        Label("radius", (LEFT, 425.0, 56.0, 0.0), "Radius", SMALL, SUBTLE),
    ]
    for axis, words in enumerate(("outward", "up", "forward")):
        rect: Rect = (LEFT + 62 + axis * (wide + 12), 408.0, wide, BUTTON_PX)
        low = -MAX_RADIUS
        widgets.append(
            Slider(
                f"radius:{axis}",
                rect,
                words,
                key.radius[axis],
                low,
                MAX_RADIUS,
                radius(axis),
                step=0.01,
                label_width=52.0,
                value_width=34.0,
            )
        )
    return widgets


def _with_path(state: EditorState, path: str) -> EditorState:
    """Choose a path; one that would be a line gets a radius that can be seen."""
    key = state.document.hand_key
    if key is None or path == "line" or any(key.radius):
        return _changed(state, path=path)
    radius = {"circle": (0.15, 0.15, 0.0), "wave": (0.2, 0.0, 0.0)}.get(path, (0.0, 0.15, 0.0))
    return _changed(state, path=path, radius=radius)


def _hint(left: float, lines: tuple[str, ...]) -> list[Widget]:
    return [
        Label(f"hint:{number}", (left, 190.0 + 24 * number, COLUMN, 0.0), words, NORMAL, SUBTLE)
        for number, words in enumerate(lines)
    ]


def _changed(state: EditorState, **changes: Any) -> EditorState:
    return edited(state, change_key(state.document, **changes))
