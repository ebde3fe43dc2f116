"""A little cube, board and screen, drawn at any tilt: what the coach shows with."""

import cv2
import numpy as np
from numpy.typing import NDArray

from app.ui.canvas import SUBPIXEL, Canvas
from app.ui.palette import ACTION, INK, PAPER, RULE, Color, between
from tracking.geometry import se3

Array = NDArray[np.float64]
Place = tuple[float, float]

SIDES: tuple[tuple[tuple[int, int, int], Color], ...] = (
    ((0, 0, -1), ACTION["walk"]),
    ((0, 0, 1), ACTION["run"]),
    ((-1, 0, 0), ACTION["idle"]),
    ((1, 0, 0), ACTION["shout"]),
    ((0, -1, 0), ACTION["kiss"]),
    ((0, 1, 0), between(ACTION["idle"], INK, 0.3)),
)
"""Outward normals of the sides in the picture's axes (x right, y down, z away), and the colour of
the marker on each."""

EYE = 6.0
"""How far away it is seen from, in half edges: near enough to tell which way it tips."""

PATTERN = ((-0.28, -0.28), (0.28, -0.28), (-0.28, 0.28))
"""White cells of the little markers, so that they look like one."""


def draw_cube(canvas: Canvas, middle: Place, half: float, turn: Array) -> None:
    """Draw a cube with half an edge of `half`, turned by a rotation vector (3,) from square."""
    rotation = se3.rotation(np.asarray(turn, float))
    for normal, color in SIDES:
        outward = rotation @ np.array(normal, float)
        centre = outward + (0, 0, EYE)
        if outward @ centre >= 0:
            continue
        first = rotation @ np.roll(np.array(normal, float), 1)
        second = np.cross(outward, first)
        light = 0.55 + 0.45 * max(0.0, float(outward @ (-0.25, -0.55, -0.8)))
        paper = between(INK, PAPER, 0.55 + 0.45 * light)

        def plane(size: float, x: float = 0.0, y: float = 0.0) -> Array:
            square = np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)]) * size + (x, y)
            points = outward + square[:, :1] * first + square[:, 1:] * second  # noqa: B023
            return _seen(points, middle, half)

        fill(canvas, plane(1.0), paper)
        canvas.line(plane(1.0), between(paper, INK, 0.25), 1.5, closed=True)
        fill(canvas, plane(0.68), between(INK, color, light))
        for x, y in PATTERN:
            fill(canvas, plane(0.17, x, y), paper)


def draw_board(canvas: Canvas, middle: Place, half: float, turn: Array) -> None:
    """Draw a chessboard that is `half` high and low, turned by a rotation vector (3,)."""
    rotation = se3.rotation(np.asarray(turn, float))
    columns, rows = 5, 7
    for row in range(rows):
        for column in range(columns):
            corner = np.array([column - columns / 2, row - rows / 2])
            square = corner + np.array([(0, 0), (1, 0), (1, 1), (0, 1)])
            flat = np.column_stack([square * (2.5 / rows), np.zeros(4)])
            color = INK if (row + column) % 2 == 0 else PAPER
            fill(canvas, _seen(flat @ rotation.T, middle, half), color)


def draw_screen(canvas: Canvas, middle: Place, size: Place) -> None:
    """Draw the camera's picture as a frame."""
    half = np.array(size) / 2
    corners = np.array(middle) + half * np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)])
    fill(canvas, corners, between(PAPER, RULE, 0.5))
    canvas.line(corners, between(RULE, INK, 0.25), 3, closed=True)


def fill(canvas: Canvas, points: Array, color: Color) -> None:
    """Fill a convex outline (n, 2), in design units."""
    fixed = np.round((points * canvas.scale - 0.5) * 2**SUBPIXEL).astype(np.int32)
    cv2.fillConvexPoly(canvas.color, fixed, color, cv2.LINE_AA, SUBPIXEL)


def _seen(points: Array, middle: Place, half: float) -> Array:
    """Project points (n, 3), in half edges, with the cube's middle in `middle`."""
    return np.asarray(points[:, :2] / (1 + points[:, 2:] / EYE) * half + middle, np.float64)
