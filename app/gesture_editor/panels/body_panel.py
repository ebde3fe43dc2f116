"""Sliders of trunk and head, and of expressivity."""

from dataclasses import replace

from cubeling.app.gesture_editor.editing.edits import change_expressivity, change_key
from cubeling.app.gesture_editor.editing.state import EditorState, edited
from cubeling.app.gesture_editor.panels.fields import Slider
from cubeling.app.gesture_editor.panels.widgets import (
    NORMAL,
    SMALL,
    Button,
    Label,
    Rect,
    Sheet,
    Widget,
)
from cubeling.app.ui.palette import RULE
from cubeling.characters.behaviour import NEUTRAL, BodyKey, GestureExpressivity

LEFT, MIDDLE, RIGHT = 756.0, 1016.0, 1264.0
"""Left edges of the panel's two columns, and the right edge of the second."""

COLUMN = RIGHT - MIDDLE
"""Width of a column."""

BUTTON_PX = 24.0
"""Height of a small button."""

EXPRESSIVITY_TOP = 444.0
"""Where the sliders of expressivity begin."""

PARAMETERS = (
    ("spatial", "Spatial extent", -1.0),
    ("openness", "Openness", 0.0),
    ("power", "Power", 0.0),
    ("fluidity", "Fluidity", -1.0),
    ("bias", "Bias", -1.0),
    ("tension", "Tension", -1.0),
)
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


def body_sliders(key: BodyKey) -> list[Widget]:
    """Return the sliders of trunk, shoulders and head."""
    widgets: list[Widget] = []
    for number, (name, (words, high)) in enumerate(BODY_LIMITS.items()):
        rect: Rect = (LEFT, 104.0 + 34 * number, RIGHT - LEFT, BUTTON_PX)
        degrees = name.endswith("_deg")
        widgets.append(
            Slider(
                name,
                rect,
                words,
                getattr(key, name),
                -high if degrees else 0.0,
                high,
                lambda state, value, name=name: edited(  # type: ignore[misc]
                    state, change_key(state.document, **{name: value})
                ),
                "°" if degrees else "",
                1.0 if degrees else 0.05,
                label_width=126.0,
            )
        )
    return widgets


def expressivity_sliders(now: GestureExpressivity) -> list[Widget]:
    """Return the six parameters, and what makes them neutral."""

    def neutral(state: EditorState) -> EditorState:
        gesture = replace(state.document.gesture, expressivity=NEUTRAL)
        return edited(state, replace(state.document, gesture=gesture))

    top = EXPRESSIVITY_TOP
    widgets: list[Widget] = [
        Sheet("rule", (LEFT, top - 4, RIGHT - LEFT, 1.5), RULE, 0.7),
        Label("expressivity", (LEFT, top + 20, 200.0, 0.0), "Expressivity", NORMAL + 1.5),
        Button(
            "neutral",
            (RIGHT - 70, top + 4, 70.0, BUTTON_PX),
            "neutral",
            neutral,
            enabled=now != NEUTRAL,
            size=SMALL,
        ),
    ]
    for number, (name, words, low) in enumerate(PARAMETERS):
        left = (LEFT, MIDDLE)[number // 3]
        rect: Rect = (
            left,
            top + 32 + 26 * (number % 3),
            COLUMN - 6 * (number < 3),
            BUTTON_PX,
        )
        widgets.append(
            Slider(
                name,
                rect,
                words,
                getattr(now, name),
                low,
                1.0,
                lambda state, value, name=name: edited(  # type: ignore[misc]
                    state, change_expressivity(state.document, name, value)
                ),
                label_width=92.0,
            )
        )
    return widgets
