"""The sheet to print, cut, fold and glue."""

from pathlib import Path

import numpy as np

from cubeling.files import write_whole
from cubeling.tracking.cube.icons import FOLD_GAP_SHARE, ICON_COLOURS, ICON_SHARE, icon_paths
from cubeling.tracking.cube.marker import marker_loops
from cubeling.tracking.cube.model import CubeModel, Face
from cubeling.tracking.cube.printing.layout import SheetLayout
from cubeling.tracking.cube.printing.notes import draw_notes
from cubeling.tracking.cube.printing.pdf_page import PdfPage
from cubeling.tracking.cube.printing.unfolding import Tab
from cubeling.tracking.errors import TrackingError

CUT_COLOUR = (70, 76, 90)
FOLD_COLOUR = (150, 156, 168)
TAB_COLOUR = (246, 243, 236)
CAPTION_COLOUR = (128, 134, 148)
BLACK = (0, 0, 0)

QUARTER_TURNS = tuple(np.array([[c, s], [-s, c]]) for c, s in ((1, 0), (0, 1), (-1, 0), (0, -1)))
"""The four turns of a face on paper, by which every side gets its icon."""


def write_sheet(
    cube: CubeModel, path: str | Path, *, edge_mm: float | None = None, paper: str = "a4"
) -> None:
    """Write a cube as a PDF page to print at 100 %, cut out, fold and glue.

    Parameters
    ----------
    cube
        The cube; faces without a marker stay blank.
    path
        The file; it is written completely or not at all, with the same bytes every time.
    edge_mm
        Edge to print [mm] instead of the cube's own; the markers scale with it.
    paper
        "a4", "letter" or "a3", in upper or lower case.

    Raises
    ------
    TrackingError
        The net does not fit the paper, a marker does not fit its face, or the file cannot be
        written.
    """
    if edge_mm is not None:
        cube = cube.scale(edge_mm / 1000)
    sheet = SheetLayout(cube, paper.lower())
    page = PdfPage(*sheet.page_size, f"{cube.name} cube, {cube.edge * 1000:g} mm")
    draw_net(page, sheet)
    draw_notes(page, sheet)
    write_whole(path, page.to_bytes(), TrackingError)


def draw_net(page: PdfPage, sheet: SheetLayout) -> None:
    """Draw the net: tabs, markers, captions, then the lines to fold and to cut."""
    for tab in sheet.net.tabs():
        _draw_tab(page, sheet, tab)
    for face in sheet.cube.faces:
        corners = sheet.marker_corners(face)
        across, down = corners[1] - corners[0], corners[3] - corners[0]
        loops = marker_loops(sheet.cube.dictionary, face.marker_id)
        page.fill([corners[0] + loop @ np.array([across, down]) for loop in loops], BLACK)
        _draw_caption(page, sheet, face)
    for start, end in sheet.net.folds():
        page.dashes(sheet.place(start), sheet.place(end), 0.3, FOLD_COLOUR)
    page.stroke(sheet.place(sheet.net.outline()), 0.45, CUT_COLOUR, closed=True)


def _draw_tab(page: PdfPage, sheet: SheetLayout, tab: Tab) -> None:
    corners = sheet.place(tab.corners)
    page.fill([corners], TAB_COLOUR)
    x, y = corners.mean(axis=0)
    depth = float(np.ptp(corners, axis=0).min())
    size = min(3.0, depth * 0.35)
    if tab.side == "right":
        page.text("glue", x + size * 0.35, y, size, CAPTION_COLOUR, align=0.5, turn=90)
    else:
        page.text("glue", x, y + size * 0.35, size, CAPTION_COLOUR, align=0.5)


def _draw_caption(page: PdfPage, sheet: SheetLayout, face: Face) -> None:
    """Draw the icon on all four sides, upright for who looks from there; role and name below.

    They are close to the fold; the gap to the marker is its quiet zone.
    """
    edge = sheet.cube.edge * 1000
    margin = (edge - sheet.cube.marker_size * 1000) / 2
    height, foot = ICON_SHARE * margin, edge / 2 - FOLD_GAP_SHARE * margin
    middle = sheet.place(sheet.net.centre(face.name))
    if face.icon:
        paths = [loop * height + (-height / 2, foot - height) for loop in icon_paths(face.icon)]
        for turn in QUARTER_TURNS:
            page.fill([middle + loop @ turn for loop in paths], ICON_COLOURS[face.icon])
    size, gap = 0.4 * margin, 0.25 * margin
    baseline = middle[1] + foot - 0.35 * height
    beside = (height / 2 if face.icon else 0.0) + gap
    colour = ICON_COLOURS.get(face.icon, CAPTION_COLOUR)
    page.text(face.role, middle[0] - beside, baseline, size, colour, bold=True, align=1.0)
    page.text(face.name, middle[0] + beside, baseline, size, CAPTION_COLOUR)
