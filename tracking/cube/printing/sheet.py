"""The sheet to print, cut, fold and glue."""

import os
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from tracking.cube.icons import INK, icon_paths
from tracking.cube.marker import marker_loops
from tracking.cube.model import CubeModel, Face
from tracking.cube.printing.layout import SheetLayout
from tracking.cube.printing.unfolding import Tab
from tracking.errors import TrackingError

if TYPE_CHECKING:
    from tracking.cube.printing.pdf_page import PdfPage

Array = NDArray[np.float64]

CUT = (70, 76, 90)
FOLD = (150, 156, 168)
TAB_FILL = (246, 243, 236)
SOFT = (128, 134, 148)
BLACK = (0, 0, 0)


def write_sheet(
    cube: CubeModel, path: str | Path, *, edge_mm: float | None = None, paper: str = "a4"
) -> None:
    """Write a cube as a PDF page to print at 100 %, cut out, fold and glue.

    Parameters
    ----------
    cube
        The cube; faces that it does not describe stay blank.
    path
        Where to; the file appears whole or not at all, and is the same bytes every time.
    edge_mm
        Edge of the cube [mm] where it shall not be the cube's own; markers scale with it.
    paper
        "a4", "letter" or "a3", in either case.

    Raises
    ------
    TrackingError
        The net does not fit the paper, a marker does not fit its face, or the file cannot be
        written.
    """
    from tracking.cube.printing.notes import draw_notes
    from tracking.cube.printing.pdf_page import (
        PdfPage,  # its PDF library would slow the start of every other command
    )

    if edge_mm is not None:
        cube = cube.scaled(edge_mm / 1000)
    sheet = SheetLayout(cube, paper.lower())
    pen = PdfPage(*sheet.page, f"{cube.name} cube, {cube.edge * 1000:g} mm")
    draw_net(pen, sheet)
    draw_notes(pen, sheet)
    _save(pen, Path(path))


def draw_net(pen: "PdfPage", sheet: SheetLayout) -> None:
    """Draw the cross: tabs, markers, captions, then the lines to fold and to cut."""
    for tab in sheet.net.tabs():
        _draw_tab(pen, sheet, tab)
    for face in sheet.cube.faces:
        corners = sheet.marker_corners(face)
        across, down = corners[1] - corners[0], corners[3] - corners[0]
        loops = marker_loops(sheet.cube.dictionary, face.marker_id)
        pen.fill([corners[0] + loop @ np.array([across, down]) for loop in loops], BLACK)
        _draw_caption(pen, sheet, face)
    for start, end in sheet.net.folds():
        pen.dashes(sheet.place(start), sheet.place(end), 0.3, FOLD)
    pen.stroke(sheet.place(sheet.net.outline()), 0.45, CUT, closed=True)


def _draw_tab(pen: "PdfPage", sheet: SheetLayout, tab: Tab) -> None:
    corners = sheet.place(tab.corners)
    pen.fill([corners], TAB_FILL)
    x, y = corners.mean(axis=0)
    depth = float(np.ptp(corners, axis=0).min())
    size = min(3.0, depth * 0.35)
    if tab.side == "right":
        pen.text("glue", x + size * 0.35, y, size, SOFT, align=0.5, turn=90)
    else:
        pen.text("glue", x, y + size * 0.35, size, SOFT, align=0.5)


def _draw_caption(pen: "PdfPage", sheet: SheetLayout, face: Face) -> None:
    """Put icon, role and name under the marker, close to the fold and away from the black.

    The gap to the marker is its quiet zone: a camera finds the black square by the white around it.
    """
    edge = sheet.cube.edge * 1000
    margin = (edge - sheet.cube.marker_size * 1000) / 2
    height = 0.7 * margin
    words = [word for word in (face.role, face.name) if word]
    size, gap = 0.52 * height, 0.3 * height
    widths = [pen.text_width(word, size, bold=word is face.role) for word in words]
    icon = height if face.icon else 0.0
    x, middle = sheet.place(sheet.net.centre(face.name))
    foot = middle + edge / 2 - 0.1 * margin
    x -= (icon + sum(widths) + gap * (len(words) - 1 + bool(face.icon))) / 2
    if face.icon:
        pen.fill(
            [loop * height + (x, foot - height) for loop in icon_paths(face.icon)], INK[face.icon]
        )
        x += icon + gap
    for word, width in zip(words, widths, strict=True):
        role = word is face.role
        colour = INK.get(face.icon, SOFT) if role else SOFT
        pen.text(word, x, foot - 0.3 * height, size, colour, bold=role)
        x += width + gap


def _save(pen: "PdfPage", path: Path) -> None:
    partial = path.with_name(path.name + ".partial")
    try:
        pen.save(partial)
        os.replace(partial, path)
    except OSError as error:
        partial.unlink(missing_ok=True)
        raise TrackingError(f"cannot write the sheet '{path}': {error.strerror}") from error
