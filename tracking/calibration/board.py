"""A ChArUco board: a chessboard with markers in its white squares."""

from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import cv2
import numpy as np

from cubeling.files import write_whole
from cubeling.tracking.cube.marker import marker_loops
from cubeling.tracking.cube.model import aruco_dictionary
from cubeling.tracking.cube.printing.layout import PAPER_SIZES_MM
from cubeling.tracking.cube.printing.pdf_page import PdfPage
from cubeling.tracking.errors import TrackingError
from cubeling.tracking.geometry.arrays import Array

BLACK = (0, 0, 0)

MARGIN_MM = 12.0
"""Width of the white margin around the board."""

RULER_MM = 100.0
"""Length of the check ruler."""


@dataclass(frozen=True)
class Board:
    """A board of squares, the first one black, with a marker in every white one.

    The defaults are those of OpenCV's examples, so their prints can be used as well. A calibration
    needs no lengths, so the print may have any size.
    """

    columns: int = 5
    """Number of squares from left to right."""

    rows: int = 7
    """Number of squares from top to bottom."""

    square: float = 0.036
    """Side of a square [m]."""

    marker_share: float = 0.5
    """Side of a marker relative to its square's; it does not affect the corners."""

    dictionary: str = "DICT_6X6_250"
    """OpenCV's name of the markers' dictionary."""

    @cached_property
    def pattern(self) -> cv2.aruco.CharucoBoard:
        """The board as an OpenCV object."""
        return cv2.aruco.CharucoBoard(
            (self.columns, self.rows),
            self.square,
            self.square * self.marker_share,
            aruco_dictionary(self.dictionary),
        )

    @property
    def points(self) -> Array:
        """The inner corners, ((columns − 1)(rows − 1), 3) [m], z = 0, in OpenCV's order."""
        return np.asarray(self.pattern.getChessboardCorners(), np.float64)

    @property
    def outline(self) -> Array:
        """The four outer corners, (4, 3) [m]."""
        width, height = self.columns * self.square, self.rows * self.square
        return np.array([(0, 0, 0), (width, 0, 0), (width, height, 0), (0, height, 0)], np.float64)


def write_board(path: str | Path, paper: str = "a4") -> Board:
    """Write a board to print as a PDF, as large as the page allows, in whole mm per square.

    Parameters
    ----------
    path
        The file; it is written completely or not at all.
    paper
        "a4", "letter" or "a3".

    Returns
    -------
    The board that is on the page.

    Raises
    ------
    TrackingError
        The paper is unknown, or the file cannot be written.
    """
    if paper not in PAPER_SIZES_MM:
        raise TrackingError(f"unknown paper '{paper}': choose {', '.join(PAPER_SIZES_MM)}")
    height, width = PAPER_SIZES_MM[paper]  # the page is upright
    room = min((width - 2 * MARGIN_MM) / 5, (height - 2 * MARGIN_MM - 14) / 7)
    board = Board(square=float(np.floor(room)) / 1000)
    pen = PdfPage(width, height, "ChArUco board")
    pen.fill(_black_areas(board, np.array([(width - 5000 * board.square) / 2, MARGIN_MM])), BLACK)
    _draw_ruler(pen, width, height - MARGIN_MM)
    write_whole(path, pen.to_bytes(), TrackingError)
    return board


def _black_areas(board: Board, corner: Array) -> list[Array]:
    """Return the outlines of all black areas on the page [mm]."""
    side = board.square * 1000
    square = side * np.array([(0, 0), (1, 0), (1, 1), (0, 1)], np.float64)
    loops: list[Array] = []
    marker = 0
    for row in range(board.rows):
        for column in range(board.columns):
            at = corner + side * np.array([column, row])
            if (row + column) % 2 == 0:
                loops.append(at + square)
                continue
            inset = at + side * (1 - board.marker_share) / 2
            loops += [
                inset + side * board.marker_share * loop
                for loop in marker_loops(board.dictionary, marker)
            ]
            marker += 1
    return loops


def _draw_ruler(pen: PdfPage, width: float, y: float) -> None:
    left = (width - RULER_MM) / 2
    pen.stroke([(left, y), (left + RULER_MM, y)], 0.3, BLACK)
    for tick in (0.0, RULER_MM / 2, RULER_MM):
        pen.stroke([(left + tick, y - 1.5), (left + tick, y + 1.5)], 0.3, BLACK)
    words = "100 mm. Print on stiff paper or glue to a board: it must be flat. Any size will do."
    pen.text(words, width / 2, y - 3.5, 3.4, BLACK, align=0.5)
