"""The bar at the top."""

from imgui_bundle import imgui

from cubeling.app.workshop.gesture_editor.editing import actions
from cubeling.app.workshop.gesture_editor.editing.edits import change_gesture, gesture_name
from cubeling.app.workshop.gesture_editor.panels.ui import GAP, Ui

NAME_WIDTH = 180.0
"""Width of the name [design units]."""


def upper_bar(ui: Ui) -> None:
    """Draw name, meaning, files, history and help."""
    state, gesture = ui.state, ui.state.document.gesture
    wide = imgui.get_content_region_avail().x / ui.unit
    name = ui.text_field("name", gesture.name, "NAME", NAME_WIDTH)
    if name is not None:
        ui.edit(change_gesture(ui.state.document, name=gesture_name(name)))
    buttons = (
        ("New", 50.0, "Ctrl+N", True),
        ("Open", 56.0, "Ctrl+O", True),
        ("Import", 66.0, "Ctrl+I", True),
        ("Save", 56.0, "Ctrl+S", True),
        ("Save as", 72.0, "Ctrl+Shift+S", True),
        ("Undo", 58.0, "Ctrl+Z", bool(state.past)),
        ("Redo", 58.0, "Ctrl+Y", bool(state.future)),
        ("?", 32.0, "F1", True),
    )
    groups = {"Undo": 18.0, "?": 18.0}
    used = sum(width + groups.get(label, GAP) for label, width, *_ in buttons)
    imgui.same_line()
    room = wide - NAME_WIDTH - used - 26.0
    summary = ui.text_field("summary", gesture.summary, "what it means", room)
    if summary is not None:
        ui.edit(change_gesture(ui.state.document, summary=summary.strip()))
    imgui.same_line(0.0, 18.0 * ui.unit)
    for label, width, keys, enabled in buttons:
        if label != "New":
            imgui.same_line(0.0, groups.get(label, GAP) * ui.unit)
        unsaved = label == "Save" and state.changed
        if ui.button(label.lower(), label, width, enabled=enabled, chosen=unsaved):
            ui.do(actions.ACTIONS[keys])
        imgui.set_item_tooltip(keys)
