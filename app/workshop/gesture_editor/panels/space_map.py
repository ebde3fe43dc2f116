"""The gesture space as a map: the sectors across and up, around a figure that faces you."""

from itertools import pairwise

import numpy as np
from imgui_bundle import imgui

from cubeling.app.ui.palette import INK, PAPER, RULE, between, bgr
from cubeling.app.ui.panels.drawing.style import pack_color
from cubeling.app.workshop.gesture_editor.panels.ui import ACCENT, SUBTLE, Rect, Ui
from cubeling.characters.behaviour import SECTORS_X, SECTORS_Y, Place

LABEL_WIDTH, LABEL_HEIGHT, LABEL_SIZE = 62.0, 20.0, 12.5
"""Room for the names of rows, to the left, and of columns, above [design units]."""

CARD = bgr("#fffdf8")
"""Background of the sectors."""

FIGURE = between(PAPER, INK, 0.14)
"""Colour of the figure."""

HAND_RADIUS = 7.5
"""Of the disc that stands for the hand [design units]."""


def space_map(
    ui: Ui, place: Place | None, width: float, height: float, *, left: bool
) -> tuple[str, str] | None:
    """Draw the sectors of a hand; return the one that is clicked, or dragged to.

    Parameters
    ----------
    ui
        Where it is drawn.
    place
        Where the hand is; None for nowhere.
    width, height
        Size of the map [design units].
    left
        Whether it is the left hand, whose own side is to the right of the map.
    """
    columns = SECTORS_X[::-1] if left else SECTORS_X
    origin, unit = imgui.get_cursor_screen_pos(), ui.unit
    imgui.dummy((width * unit, height * unit))
    grid = (
        origin.x + LABEL_WIDTH * unit, origin.y + LABEL_HEIGHT * unit,
        (width - LABEL_WIDTH) * unit, (height - LABEL_HEIGHT) * unit,
    )  # fmt: skip
    below = imgui.get_cursor_pos()
    imgui.set_cursor_screen_pos(grid[:2])
    imgui.invisible_button("map", grid[2:])
    ui.map_held = imgui.is_item_active()
    wide, high = grid[2] / len(columns), grid[3] / len(SECTORS_Y)
    for row, y in enumerate(SECTORS_Y):
        for column, x in enumerate(columns):
            cell = grid[0] + column * wide, grid[1] + row * high, wide, high
            ui.places[f"sector:{x}:{y}"] = cell
    shown = None if place is None or place.contact else ui.places[f"sector:{place.x}:{place.y}"]
    _draw(ui, grid, columns, shown)
    imgui.set_cursor_pos(below)
    imgui.dummy((0.0, 0.0))
    if not ui.map_held:
        return None
    mouse = imgui.get_mouse_pos()
    column = int(np.clip((mouse.x - grid[0]) // wide, 0, len(columns) - 1))
    row = int(np.clip((mouse.y - grid[1]) // high, 0, len(SECTORS_Y) - 1))
    return columns[column], SECTORS_Y[row]


def _draw(ui: Ui, grid: Rect, columns: tuple[str, ...], shown: Rect | None) -> None:
    """Draw the figure, the sectors with their names, and the hand."""
    canvas, unit = imgui.get_window_draw_list(), ui.unit
    left, top, width, height = grid
    wide, high = width / len(columns), height / len(SECTORS_Y)
    canvas.add_rect_filled((left, top), (left + width, top + height), pack_color(CARD), 8.0 * unit)
    _figure(grid, wide, high, left + wide * (columns.index("XC") + columns.index("XOppC") + 1) / 2)
    if shown is not None:
        x, y = shown[:2]
        color = pack_color(ACCENT, 0.35)
        canvas.add_rect_filled((x + 1, y + 1), (x + wide - 1, y + high - 1), color, 5.0 * unit)
    for number, name in enumerate(columns):
        x = left + number * wide
        place = x + wide / 2, top - 0.5 * LABEL_HEIGHT * unit
        ui.write(name[1:], place, SUBTLE, LABEL_SIZE, 0.5)
        if number:
            canvas.add_line((x, top), (x, top + height), pack_color(RULE), unit)
    for number, name in enumerate(SECTORS_Y):
        y = top + number * high
        ui.write(name[1:], (left - 8.0 * unit, y + high / 2), SUBTLE, LABEL_SIZE, 1.0)
        if number:
            canvas.add_line((left, y), (left + width, y), pack_color(RULE), unit)
    if shown is not None:
        middle = shown[0] + wide / 2, shown[1] + high / 2
        canvas.add_circle_filled(middle, (HAND_RADIUS + 1.5) * unit, pack_color(CARD))
        canvas.add_circle_filled(middle, HAND_RADIUS * unit, pack_color(ACCENT))


def _figure(grid: Rect, wide: float, high: float, middle: float) -> None:
    """Draw head, trunk and arms about the line between the two centres."""
    canvas, color = imgui.get_window_draw_list(), pack_color(FIGURE)
    _, top, _, height = grid
    canvas.add_circle_filled((middle, top + 1.12 * high), 0.66 * high, color)
    trunk = (middle - 0.4 * wide, top + 2.05 * high), (middle + 0.4 * wide, top + height)
    canvas.add_rect_filled(*trunk, color, 0.3 * wide)
    for side in (-1, 1):
        arm = [
            (middle + side * across * wide, top + down * high)
            for across, down in ((0.5, 2.45), (0.7, 4.2), (0.74, 5.6))
        ]
        for start, end in pairwise(arm):
            canvas.add_line(start, end, color, 0.22 * wide)
        for joint in arm:
            canvas.add_circle_filled(joint, 0.11 * wide, color)
