"""Layout of the printed sheet."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from cubeling.tracking.cube.model import FACE_AXES, CubeModel, Face
from cubeling.tracking.cube.printing.unfolding import TAB_DEPTH, Unfolding
from cubeling.tracking.errors import TrackingError
from cubeling.tracking.geometry.arrays import Array

PAPER_SIZES_MM = {"a4": (297.0, 210.0), "letter": (279.4, 215.9), "a3": (420.0, 297.0)}
"""Width and height in landscape [mm]."""

PRINTER_MARGIN_MM = 5.0
"""Margin around the page that most home printers cannot print on."""


@dataclass(frozen=True)
class PageArea:
    """Part of the page [mm from the top left]."""

    left: float

    top: float

    right: float

    bottom: float


class SheetLayout:
    """Layout of the page; the only place that converts metres to millimetres."""

    def __init__(self, cube: CubeModel, paper: str) -> None:
        if paper not in PAPER_SIZES_MM:
            raise TrackingError(f"paper '{paper}' is not known; use {', '.join(PAPER_SIZES_MM)}")
        if cube.body:
            raise TrackingError(
                f"'{cube.name}' has no sheet: it is no cube with one marker in the middle of a side"
            )
        if cube.marker_size >= cube.edge:
            raise TrackingError(
                f"the markers of the {cube.name} cube ({cube.marker_size * 1000:g} mm) "
                f"do not fit its faces ({cube.edge * 1000:g} mm)"
            )
        self.cube = cube
        self.net = Unfolding(cube.edge)
        self.page_size = PAPER_SIZES_MM[paper]
        _check_fits(cube.edge, paper)
        corners = self.net.outline() * (1000, -1000)
        middle = (corners.min(axis=0) + corners.max(axis=0)) / 2
        self._origin = np.array(self.page_size) / 2 - middle

    def place(self, points: ArrayLike) -> Array:
        """Map points of the net's paper frame [m] to the page [mm from the top left], (…, 2)."""
        return np.asarray(np.asarray(points, float) * (1000.0, -1000.0) + self._origin)

    def corner(self, row: str, column: str) -> PageArea:
        """Free space next to the cross: row "top" or "bottom", column "left" or "right"."""
        inset = PRINTER_MARGIN_MM + 4
        (right, upper), (left, lower) = self.place(self.net.square("front"))[[1, 3]]
        tab = TAB_DEPTH * self.cube.edge * 1000
        x = (inset, left - 7) if column == "left" else (right + 8, self.page_size[0] - inset)
        foot = self.page_size[1] - inset
        y = (inset, upper - tab - 3) if row == "top" else (lower + tab + 4, foot)
        return PageArea(float(x[0]), float(y[0]), float(x[1]), float(y[1]))

    def marker_corners(self, face: Face) -> Array:
        """Corners of a face's marker on the page, (4, 2) [mm], unfolded from the cube."""
        flat = face.corners @ np.transpose(FACE_AXES[face.name])
        return self.place(flat + self.net.centre(face.name))


def _check_fits(edge: float, paper: str) -> None:
    if edge * 1000 <= largest_edge_mm(paper) + 1e-6:
        return
    bigger = [
        f"--paper {name} takes {largest_edge_mm(name):g} mm"
        for name in PAPER_SIZES_MM
        if largest_edge_mm(name) >= max(edge * 1000, largest_edge_mm(paper) + 1)
    ]
    raise TrackingError(
        f"a cube of {edge * 1000:g} mm does not fit on {paper}, which takes at most "
        f"{largest_edge_mm(paper):g} mm" + (f"; {bigger[0]}" if bigger else "")
    )


def largest_edge_mm(paper: str) -> float:
    """Edge of the largest cube whose net fits a paper, in whole millimetres."""
    room = np.array(PAPER_SIZES_MM[paper]) - 2 * PRINTER_MARGIN_MM
    return float(np.floor(np.min(room / Unfolding(1.0).size()) + 1e-9))
