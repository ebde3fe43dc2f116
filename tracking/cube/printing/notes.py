"""The notes around the net: title, meaning of the faces, instructions, and ruler."""

import numpy as np

from cubeling.tracking.cube.icons import ICON_COLOURS, icon_paths
from cubeling.tracking.cube.model import FACE_AXES
from cubeling.tracking.cube.printing.layout import PageArea, SheetLayout
from cubeling.tracking.cube.printing.pdf_page import Colour, PdfPage
from cubeling.tracking.geometry.arrays import Array

LINE_COLOUR: Colour = (52, 58, 78)
TEXT_COLOUR: Colour = (96, 102, 118)
WHITE: Colour = (255, 255, 255)
MASCOT_COLOUR: Colour = (205, 230, 210)

ASSEMBLY_STEPS: tuple[tuple[str, str, Colour], ...] = (
    ("cut", "Cut along the thick line, around all the tabs.", (231, 96, 70)),
    ("fold", "Fold every dashed line away from you, and sharply.", (42, 157, 143)),
    ("glue", "Glue the tabs inside. Press each and count to ten.", (142, 118, 200)),
)
RULER_NOTE = "must be 100 mm: print at 100 %, no fit-to-page"

AXONOMETRY = np.array([[0.8, -0.45], [0.0, 1.0], [-0.8, -0.45]]) * (1, 0.9)
"""Axonometric projection of the cube's x, y, z axes on paper, y up."""


def draw_notes(page: PdfPage, sheet: SheetLayout) -> None:
    """Fill the four corners next to the cross."""
    _draw_cube_view(page, sheet, sheet.corner("top", "left"))
    _draw_title(page, sheet, sheet.corner("top", "right"))
    box = sheet.corner("bottom", "right")
    _draw_steps(page, box)
    _draw_ruler(page, box.left, box.bottom - 1)
    _draw_facts(page, sheet, sheet.corner("bottom", "left"))


def _draw_title(page: PdfPage, sheet: SheetLayout, box: PageArea) -> None:
    cube, width = sheet.cube, box.right - box.left
    title = f"The {cube.name} cube"
    size = min(10.0, 10.0 * width / page.text_width(title, 10.0, bold=True))
    y = box.top + 0.75 * size
    page.text(title, box.left, y, size, LINE_COLOUR, bold=True)
    y += 3
    for line in page.lines(cube.hint, width, 4.0):
        y += 5.2
        page.text(line, box.left, y, 4.0, TEXT_COLOUR)
    roles = {face.role or face.icon: face.icon for face in cube.faces if face.icon}
    icon = min(15.0, (width - 8 * len(roles)) / max(len(roles), 1))
    y = min(y + 6, box.bottom - icon - 6)
    for number, (role, name) in enumerate(roles.items()):
        x = box.left + number * (icon + 10)
        page.fill([loop * icon + (x, y) for loop in icon_paths(name)], ICON_COLOURS[name])
        page.text(role, x + icon / 2, y + icon + 4.6, 4.0, ICON_COLOURS[name], bold=True, align=0.5)


def _draw_cube_view(page: PdfPage, sheet: SheetLayout, box: PageArea) -> None:
    """Draw the finished cube with icons instead of markers, which no camera takes for the cube."""
    edge = min(19.0, (box.right - box.left) / 1.9, (box.bottom - box.top) / 2)
    middle = np.array([(box.left + box.right) / 2, (box.top + box.bottom) / 2])
    icons = {face.name: face.icon for face in sheet.cube.faces}
    for name, shade in (("front", 252), ("right", 236), ("top", 245)):
        right, up = (np.array(axis, float) for axis in FACE_AXES[name])
        corner = (np.cross(right, up) - right + up) / 2  # upper left of the face, in edges

        def on_page(
            loop: Array, corner: Array = corner, right: Array = right, up: Array = up
        ) -> Array:
            points = corner + loop[:, :1] * right - loop[:, 1:] * up
            return np.asarray(middle + edge * (points @ AXONOMETRY) * (1, -1))

        square = on_page(np.array([(0, 0), (1, 0), (1, 1), (0, 1)], float))
        page.fill([square], (shade, shade, shade - 6))
        if icon := icons.get(name):
            loops = [on_page(loop * 0.7 + 0.15) for loop in icon_paths(icon)]
            page.fill(loops, ICON_COLOURS[icon])
        page.stroke(square, 0.5, LINE_COLOUR, closed=True)


def _draw_steps(page: PdfPage, box: PageArea) -> None:
    column = (box.right - box.left) / len(ASSEMBLY_STEPS)
    radius, size = 6.0, 3.4
    for number, (icon, words, colour) in enumerate(ASSEMBLY_STEPS):
        x, y = box.left + number * column, box.top
        turn = np.linspace(0, 2 * np.pi, 60, endpoint=False)
        disc = np.column_stack([np.cos(turn), np.sin(turn)]) * radius + (x + radius, y + radius)
        page.fill([disc], colour)
        picture = [loop * 7.4 + (x + radius - 3.7, y + radius - 3.7) for loop in icon_paths(icon)]
        page.fill(picture, WHITE)
        name, rest = words.split(" ", 1)
        left = x + 2 * radius + 2.5
        page.text(f"{number + 1}. {name}", left, y + 3.4, 4.2, colour, bold=True)
        for row, line in enumerate(page.lines(rest, column - 2 * radius - 5, size)):
            page.text(line, left, y + 8 + 4.2 * row, size, TEXT_COLOUR)


def _draw_ruler(page: PdfPage, x: float, y: float) -> None:
    page.text(RULER_NOTE, x, y, 3.2, TEXT_COLOUR)
    line = y - 5.5
    page.stroke([(x, line), (x + 100, line)], 0.25, LINE_COLOUR)
    for millimetre in range(0, 101, 5):
        height = 3.2 if millimetre % 50 == 0 else 2.4 if millimetre % 10 == 0 else 1.4
        at = x + millimetre
        page.stroke([(at, line), (at, line - height)], 0.25, LINE_COLOUR)
        if millimetre % 10 == 0:
            page.text(str(millimetre), at, line - 4.2, 2.6, TEXT_COLOUR, align=0.5)


def _draw_facts(page: PdfPage, sheet: SheetLayout, box: PageArea) -> None:
    cube = sheet.cube
    height = min(38.0, box.right - box.left, box.bottom - box.top - 16)
    if height > 10:
        x, y = (box.left + box.right - height) / 2, box.top
        mascot = "idle" if any(face.icon == "idle" for face in cube.faces) else "run"
        page.fill([loop * height + (x, y) for loop in icon_paths(mascot)], MASCOT_COLOUR)
        ground = y + height * 0.945
        page.stroke([(x - 2, ground), (x + height, ground)], 0.5, MASCOT_COLOUR)
    facts = (
        f"edge {cube.edge * 1000:.4g} mm",
        f"markers {cube.marker_size * 1000:.4g} mm, {cube.dictionary}",
        f"cubeling cube {cube.name}",
    )
    for row, fact in enumerate(reversed(facts)):
        page.text(fact, box.left, box.bottom - 1 - 4 * row, 2.8, TEXT_COLOUR)
