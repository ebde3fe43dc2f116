"""Icons of a cube, a board and a screen in any orientation, with which the coach shows moves."""

import numpy as np
from numpy.typing import NDArray

from cubeling.app.ui.canvas import Canvas
from cubeling.app.ui.palette import ACTION_COLORS, INK, PAPER, RULE, Color, between
from cubeling.tracking import se3

Array = NDArray[np.float64]
Point = tuple[float, float]

FACE_COLORS: tuple[tuple[tuple[int, int, int], Color], ...] = (
    ((0, 0, -1), ACTION_COLORS["walk"]),
    ((0, 0, 1), ACTION_COLORS["run"]),
    ((-1, 0, 0), ACTION_COLORS["idle"]),
    ((1, 0, 0), ACTION_COLORS["shout"]),
    ((0, -1, 0), ACTION_COLORS["kiss"]),
    ((0, 1, 0), between(ACTION_COLORS["idle"], INK, 0.3)),
)
"""Outward normals of the faces in the picture's axes (x right, y down, z away), and the colour of
the marker on each."""

EYE_DISTANCE = 6.0
"""Distance of the eye, in half edges: near enough for perspective to show the tilt."""

MARKER_CELLS = ((-0.28, -0.28), (0.28, -0.28), (-0.28, 0.28))
"""Centres of the white cells of the marker on each face."""


def draw_cube(canvas: Canvas, middle: Point, half: float, turn: Array) -> None:
    """Draw a cube whose half edge is `half`, rotated by a rotation vector (3,)."""
    rotation = se3.rotation(np.asarray(turn, float))
    for normal, color in FACE_COLORS:
        outward = rotation @ np.array(normal, float)
        centre = outward + (0, 0, EYE_DISTANCE)
        if outward @ centre >= 0:
            continue
        first = rotation @ np.roll(np.array(normal, float), 1)
        second = np.cross(outward, first)
        light = 0.55 + 0.45 * max(0.0, float(outward @ (-0.25, -0.55, -0.8)))
        paper = between(INK, PAPER, 0.55 + 0.45 * light)

        def plane(size: float, x: float = 0.0, y: float = 0.0) -> Array:
            square = np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)]) * size + (x, y)
            points = outward + square[:, :1] * first + square[:, 1:] * second  # noqa: B023
            return _project(points, middle, half)

        canvas.fill(plane(1.0), paper)
        canvas.line(plane(1.0), between(paper, INK, 0.25), 1.5, closed=True)
        canvas.fill(plane(0.68), between(INK, color, light))
        for x, y in MARKER_CELLS:
            canvas.fill(plane(0.17, x, y), paper)


def draw_board(canvas: Canvas, middle: Point, half: float, turn: Array) -> None:
    """Draw a chessboard of half height `half`, rotated by a rotation vector (3,)."""
    rotation = se3.rotation(np.asarray(turn, float))
    columns, rows = 5, 7
    for row in range(rows):
        for column in range(columns):
            corner = np.array([column - columns / 2, row - rows / 2])
            square = corner + np.array([(0, 0), (1, 0), (1, 1), (0, 1)])
            flat = np.column_stack([square * (2.5 / rows), np.zeros(4)])
            color = INK if (row + column) % 2 == 0 else PAPER
            canvas.fill(_project(flat @ rotation.T, middle, half), color)


def draw_screen(canvas: Canvas, middle: Point, size: Point) -> None:
    """Draw the camera's picture as a frame."""
    half = np.array(size) / 2
    corners = np.array(middle) + half * np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)])
    canvas.fill(corners, between(PAPER, RULE, 0.5))
    canvas.line(corners, between(RULE, INK, 0.25), 3, closed=True)


def _project(points: Array, middle: Point, half: float) -> Array:
    """Project points (n, 3), in half edges, with the cube's centre at `middle`."""
    pixels = points[:, :2] / (1 + points[:, 2:] / EYE_DISTANCE) * half + middle
    return np.asarray(pixels, np.float64)
