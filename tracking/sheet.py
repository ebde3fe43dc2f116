"""The sheet to print, cut, fold and glue."""

import os
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray

from tracking.cube import CubeModel, Face
from tracking.errors import TrackingError
from tracking.icons import INK, icon_paths
from tracking.marker import marker_loops
from tracking.net import TAB_DEPTH, Net, Tab

if TYPE_CHECKING:
    from tracking.pen import Pen

Array = NDArray[np.float64]

PAPERS = {"a4": (297.0, 210.0), "letter": (279.4, 215.9), "a3": (420.0, 297.0)}
"""Width and height, lying [mm]."""

UNPRINTED_MM = 5.0
"""What most home printers leave white around the page."""

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
    from tracking.pen import Pen  # its PDF library would slow the start of every other command
    from tracking.sheet_notes import draw_notes

    if edge_mm is not None:
        cube = cube.scaled(edge_mm / 1000)
    sheet = Sheet(cube, paper.lower())
    pen = Pen(*sheet.page, f"{cube.name} cube, {cube.edge * 1000:g} mm")
    draw_net(pen, sheet)
    draw_notes(pen, sheet)
    _save(pen, Path(path))


@dataclass(frozen=True)
class Box:
    """Part of the page [mm from the top left]."""

    left: float
    """Its left side."""

    top: float
    """Its upper side."""

    right: float
    """Its right side."""

    bottom: float
    """Its lower side."""


class Sheet:
    """Where everything stands on the page: the one place that turns metres into millimetres."""

    def __init__(self, cube: CubeModel, paper: str) -> None:
        if paper not in PAPERS:
            raise TrackingError(f"paper '{paper}' is not known; use {', '.join(PAPERS)}")
        if cube.marker_size >= cube.edge:
            raise TrackingError(
                f"the markers of the {cube.name} cube ({cube.marker_size * 1000:g} mm) "
                f"do not fit its faces ({cube.edge * 1000:g} mm)"
            )
        self.cube = cube
        self.net = Net(cube.edge)
        self.page = PAPERS[paper]
        _check_fits(cube.edge, paper)
        corners = self.net.outline() * (1000, -1000)
        middle = (corners.min(axis=0) + corners.max(axis=0)) / 2
        self._origin = np.array(self.page) / 2 - middle

    def place(self, points: ArrayLike) -> Array:
        """From the net's paper frame [m] to the page [mm from the top left], (…, 2)."""
        return np.asarray(np.asarray(points, float) * (1000.0, -1000.0) + self._origin)

    def corner(self, row: str, column: str) -> "Box":
        """Free space beside the cross: row "top" or "bottom", column "left" or "right"."""
        inset = UNPRINTED_MM + 4
        (right, upper), (left, lower) = self.place(self.net.square("front"))[[1, 3]]
        tab = TAB_DEPTH * self.cube.edge * 1000
        x = (inset, left - 7) if column == "left" else (right + 8, self.page[0] - inset)
        y = (inset, upper - tab - 3) if row == "top" else (lower + tab + 4, self.page[1] - inset)
        return Box(float(x[0]), float(y[0]), float(x[1]), float(y[1]))

    def marker_corners(self, face: Face) -> Array:
        """Corners of a face's marker on the page, (4, 2) [mm], by unfolding those of the cube."""
        face_from_cube = np.linalg.inv(self.net.cube_from_face(face.name))
        flat = face.corners @ face_from_cube[:3, :3].T + face_from_cube[:3, 3]
        return self.place(flat[:, :2] + self.net.centre(face.name))


def draw_net(pen: "Pen", sheet: Sheet) -> None:
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


def _draw_tab(pen: "Pen", sheet: Sheet, tab: Tab) -> None:
    corners = sheet.place(tab.corners)
    pen.fill([corners], TAB_FILL)
    x, y = corners.mean(axis=0)
    depth = float(np.ptp(corners, axis=0).min())
    size = min(3.0, depth * 0.35)
    if tab.side == "right":
        pen.text("glue", x + size * 0.35, y, size, SOFT, align=0.5, turn=90)
    else:
        pen.text("glue", x, y + size * 0.35, size, SOFT, align=0.5)


def _draw_caption(pen: "Pen", sheet: Sheet, face: Face) -> None:
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


def _check_fits(edge: float, paper: str) -> None:
    if edge * 1000 <= largest_edge_mm(paper) + 1e-6:
        return
    bigger = [
        f"--paper {name} takes {largest_edge_mm(name):g} mm"
        for name in PAPERS
        if largest_edge_mm(name) >= max(edge * 1000, largest_edge_mm(paper) + 1)
    ]
    raise TrackingError(
        f"a cube of {edge * 1000:g} mm does not fit on {paper}, which takes at most "
        f"{largest_edge_mm(paper):g} mm" + (f"; {bigger[0]}" if bigger else "")
    )


def largest_edge_mm(paper: str) -> float:
    """Edge of the largest cube whose net fits a paper, in whole millimetres."""
    room = np.array(PAPERS[paper]) - 2 * UNPRINTED_MM
    return float(np.floor(np.min(room / Net(1.0).size()) + 1e-9))


def _save(pen: "Pen", path: Path) -> None:
    partial = path.with_name(path.name + ".partial")
    try:
        pen.save(partial)
        os.replace(partial, path)
    except OSError as error:
        partial.unlink(missing_ok=True)
        raise TrackingError(f"cannot write the sheet '{path}': {error.strerror}") from error
