"""Small faces that show a mood."""

import numpy as np

from cubeling.app.ui.canvas import Canvas
from cubeling.app.ui.palette import INK, PAPER, between, mood_color


def draw_face(
    canvas: Canvas, x: float, y: float, radius: float, mood: float, *, crest: bool
) -> None:
    """Draw a face in a circle; `mood` is from angry, −1, over neutral to happy, 1.

    The robot has a crest.
    """
    skin = mood_color(mood)
    shade = between(skin, INK, 0.22)
    for side in (-0.5, 0.0, 0.5) if crest else ():
        canvas.disc(x + side * radius, y - radius * (0.98 - 0.22 * abs(side)), radius * 0.2, shade)
    canvas.disc(x, y, radius, skin)
    for side in (-1, 1):
        _eye(canvas, x + side * 0.4 * radius, y - 0.18 * radius, radius, side, mood)
        canvas.disc(x + side * 0.14 * radius, y + 0.2 * radius, radius * 0.05, shade)
    _mouth(canvas, x, y + 0.48 * radius, radius, mood)


def _eye(canvas: Canvas, x: float, y: float, radius: float, side: int, mood: float) -> None:
    canvas.disc(x, y, radius * 0.24, PAPER)
    canvas.disc(x - side * radius * 0.03, y + radius * 0.03, radius * 0.15, INK)
    canvas.disc(x + radius * 0.03, y - radius * 0.05, radius * 0.055, PAPER)
    # Brows slope towards the nose when angry, and arch when happy.
    across = np.linspace(-1.0, 1.0, 9)
    anger, joy = max(0.0, -mood), max(0.0, mood)
    rise = 0.34 + 0.08 * joy - 0.08 * anger + joy * 0.07 * (1 - across**2)
    slope = 0.2 * anger * across * side
    brow = np.stack([x + 0.22 * radius * across, y - (rise + slope) * radius], axis=1)
    canvas.line(brow, INK, radius * (0.06 + 0.04 * anger))


def _mouth(canvas: Canvas, x: float, y: float, radius: float, mood: float) -> None:
    across = np.linspace(-1.0, 1.0, 17)
    reach = 0.42 + 0.08 * abs(mood)
    down = (1.0 - across**2) * mood * 0.26 - mood * 0.1
    curve = np.stack([x + across * reach * radius, y + down * radius], axis=1)
    canvas.line(curve, INK, radius * 0.1)
