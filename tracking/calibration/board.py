"""A ChArUco board: a chessboard with markers in its white squares."""

from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray

from tracking.cube.marker import marker_loops
from tracking.cube.model import aruco_dictionary
from tracking.cube.printing.pen import Pen
from tracking.errors import TrackingError

Array = NDArray[np.float64]

INK = (0, 0, 0)

PAPERS = {"a4": (210.0, 297.0), "letter": (215.9, 279.4), "a3": (297.0, 420.0)}
"""Width and height of the pages [mm]."""

MARGIN = 12.0
"""Printers leave so much of a page white [mm]."""

RULER = 100.0
"""Length of the ruler on the page [mm]."""


@dataclass(frozen=True)
class Board:
    """A board of squares, black in its first corner, with a marker in every white one.

    The defaults are those of OpenCV's own examples, so that a board from there will do as well. A
    calibration needs no lengths, so any size of print is right.
    """

    columns: int = 5
    """Squares from left to right."""

    rows: int = 7
    """Squares from top to bottom."""

    square: float = 0.036
    """Side of a square [m]."""

    share: float = 0.5
    """Side of a marker as a share of its square's; that does not matter to the corners."""

    dictionary: str = "DICT_6X6_250"
    """Name of the markers' dictionary in OpenCV."""

    @cached_property
    def pattern(self) -> cv2.aruco.CharucoBoard:
        """The board as OpenCV describes it."""
        return cv2.aruco.CharucoBoard(
            (self.columns, self.rows),
            self.square,
            self.square * self.share,
            aruco_dictionary(self.dictionary),
        )

    @property
    def points(self) -> Array:
        """The inner corners, ((columns − 1)(rows − 1), 3) [m], z = 0, in OpenCV's order."""
        return np.asarray(self.pattern.getChessboardCorners(), np.float64)

    @property
    def outline(self) -> Array:
        """Its four outer corners, (4, 3) [m]."""
        width, height = self.columns * self.square, self.rows * self.square
        return np.array([(0, 0, 0), (width, 0, 0), (width, height, 0), (0, height, 0)], np.float64)

    @property
    def fewest(self) -> int:
        """Fewer corners than this are not taken for the board."""
        return min(8, (self.columns - 1) * (self.rows - 1))


def write_board(path: str | Path, paper: str = "a4") -> Board:
    """Draw a board as large as the page allows, in whole millimetres, as a PDF to print.

    Returns
    -------
    The board that is on the page.

    Raises
    ------
    TrackingError
        The paper is unknown, or nothing can be written there.
    """
    if paper not in PAPERS:
        raise TrackingError(f"no paper is called '{paper}': choose {', '.join(PAPERS)}")
    width, height = PAPERS[paper]
    room = min((width - 2 * MARGIN) / 5, (height - 2 * MARGIN - 14) / 7)
    board = Board(square=float(np.floor(room)) / 1000)
    pen = Pen(width, height, "ChArUco board")
    side = board.square * 1000
    corner = np.array([(width - 5 * side) / 2, MARGIN])
    pen.fill(_black(board, corner), INK)
    _ruler(pen, width, height - MARGIN)
    try:
        pen.save(Path(path))
    except OSError as error:
        raise TrackingError(f"cannot write the board '{path}': {error.strerror}") from error
    return board


def _black(board: Board, corner: Array) -> list[Array]:
    """Outline all black on the page, [mm]."""
    side = board.square * 1000
    square = side * np.array([(0, 0), (1, 0), (1, 1), (0, 1)], np.float64)
    loops: list[Array] = []
    number = 0
    for row in range(board.rows):
        for column in range(board.columns):
            at = corner + side * np.array([column, row])
            if (row + column) % 2 == 0:
                loops.append(at + square)
                continue
            inset = at + side * (1 - board.share) / 2
            loops += [
                inset + side * board.share * loop for loop in marker_loops(board.dictionary, number)
            ]
            number += 1
    return loops


def _ruler(pen: Pen, width: float, y: float) -> None:
    left = (width - RULER) / 2
    pen.stroke([(left, y), (left + RULER, y)], 0.3, INK)
    for place in (0.0, RULER / 2, RULER):
        pen.stroke([(left + place, y - 1.5), (left + place, y + 1.5)], 0.3, INK)
    words = "100 mm. Print on stiff paper or glue to a board: it must be flat. Any size will do."
    pen.text(words, width / 2, y - 3.5, 3.4, INK, align=0.5)
