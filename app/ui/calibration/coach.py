"""The coach on the screen: what to do next, with a small moving drawing, and what is there already.

Everything is shown as it should look in the picture, so that left is left on the screen.
"""

import math
from collections.abc import Iterable

import cv2
import numpy as np
from numpy.typing import NDArray

from app.ui.calibration.orientation_icons import draw_board, draw_cube, draw_screen, fill
from app.ui.calibration.session import Advice
from app.ui.canvas import Canvas, Card, text_width
from app.ui.palette import ACTION, HAPPY, INK, NEUTRAL, PAPER, QUIET, RULE, between
from tracking.calibration import ViewCoverage

Picture = NDArray[np.uint8]
Array = NDArray[np.float64]

HEIGHT = 720.0
"""Height of a picture in design units."""

FLASH = 0.25
"""How long the picture's rim shines when a view was taken [s]."""

PERIOD = 1.8
"""Time of one movement of the drawing [s]."""

TILT = math.radians(34)
"""How far the drawing tips the cube."""

CORNER_WORDS = {
    "top left": "Move it to the top left corner",
    "top right": "Move it to the top right corner",
    "bottom left": "Move it to the bottom left corner",
    "bottom right": "Move it to the bottom right corner",
    "middle": "Move it to the middle",
}

WORDS = {
    "show": "Show me the {}",
    "still": "Good! Now hold it still",
    "done": "Done! Thank you",
    "": "That is all I need",
    "tilt up": "Tip the {} up",
    "tilt down": "Tip the {} down",
    "tilt left": "Turn the {} to the left",
    "tilt right": "Turn the {} to the right",
    "near": "Bring it nearer",
    "far": "Hold it further away",
    **CORNER_WORDS,
}

TURNS = {"tilt up": (-1, 0), "tilt down": (1, 0), "tilt left": (0, 1), "tilt right": (0, -1)}
"""About which axis of the picture (x right, y down) each tilt turns, right-handed."""

PLACES = {
    "top left": (-1, -1),
    "top right": (1, -1),
    "bottom left": (-1, 1),
    "bottom right": (1, 1),
    "middle": (0, 0),
}


def words_of(wish: str, target: str) -> str:
    """Return a wish in words; `target` is "cube" or "board".

    >>> words_of("tilt up", "cube")
    'Tip the cube up'
    """
    if wish.startswith("side "):
        return "Turn it over: show me another side"
    return WORDS[wish].format(target)


class CoachView:
    """Draws the coach over pictures, a picture after the other.

    Parameters
    ----------
    target
        "cube" or "board".
    """

    def __init__(self, target: str) -> None:
        self._target = target
        self._flash = -math.inf
        self._right = False
        self._since: tuple[str, float] = ("", 0.0)

    def draw(self, picture: Picture, timestamp: float, advice: Advice) -> Picture:
        """Draw on the picture (H, W, 3), in place, and return it."""
        if advice.taken:
            self._flash = timestamp
        if self._since[0] != advice.wish:
            self._since = advice.wish, timestamp
        scale = picture.shape[0] / HEIGHT
        width = picture.shape[1] / scale
        cover(picture, advice.covered)
        for outline in advice.outlines:
            trace(picture, outline, scale)
        shine = 1 - (timestamp - self._flash) / FLASH
        if shine > 0:
            _rim(picture, shine, scale)
        moved = (timestamp - self._since[1]) / PERIOD % 1.0
        self._hint(advice, width, scale).over(picture)
        self._lesson(advice.wish, moved, scale, self._clear_of(advice, width, scale)).over(picture)
        _progress(advice, width, scale).over(picture)
        return picture

    def _hint(self, advice: Advice, width: float, scale: float) -> Card:
        words = words_of(advice.wish, self._target)
        wide = text_width(words, 34) + 72
        canvas = Canvas(wide, 64, scale)
        good = advice.wish in ("still", "done", "")
        canvas.text(wide / 2, 43.5, words, 34, between(HAPPY, INK, 0.25) if good else INK, "middle")
        return canvas.card((width - wide) / 2, 22)

    def _clear_of(self, advice: Advice, width: float, scale: float) -> float:
        """Return the left edge of the drawing's card, which gives way to the target."""
        for outline in advice.outlines:
            x, y = outline.T / scale
            under = (y.max() > (HEIGHT - 240) / 2) and (y.min() < (HEIGHT + 240) / 2)
            if under and (x.max() > width - 274 if self._right else x.min() < 274):
                self._right = not self._right
        return width - 254 if self._right else 24.0

    def _lesson(self, wish: str, moved: float, scale: float, left: float) -> Card:
        canvas = Canvas(230, 200, scale)
        draw = draw_board if self._target == "board" else draw_cube
        # There and back, with a rest at both ends.
        share = float(np.clip(0.5 - 0.75 * math.cos(2 * math.pi * moved), 0, 1))
        middle = (115.0, 100.0)
        if wish in TURNS:
            draw(canvas, middle, 44.0, TILT * share * np.array([*TURNS[wish], 0.0]))
            _arrow(canvas, middle, wish)
        elif wish in PLACES or wish == "show":
            x, y = PLACES.get(wish, (0, 0))
            start = (-1.9, 0.0) if wish == "show" else (-x * 0.5, -y * 0.5)
            at = (start[0] + (x - start[0]) * share, start[1] + (y - start[1]) * share)
            draw_screen(canvas, middle, (190.0, 120.0))
            draw(canvas, (115 + 66 * at[0], 100 + 34 * at[1]), 17.0, np.array([-0.35, 0.4, 0.0]))
        elif wish in ("near", "far"):
            size = 22 + 34 * (share if wish == "near" else 1 - share)
            draw(canvas, middle, size, np.array([-0.35, 0.4, 0.0]))
        elif wish in ("done", ""):
            canvas.disc(*middle, 62, HAPPY)
            canvas.line([(84, 102), (106, 125), (147, 76)], PAPER, 14)
        elif wish == "still":
            draw(canvas, middle, 44.0, np.array([-0.35, 0.4, 0.0]))
            _ring(canvas, middle, 84.0, moved)
        else:
            draw(canvas, middle, 44.0, np.array([0.0, math.pi / 2 * share, 0.0]))
        return canvas.card(left, (HEIGHT - 200) / 2)  # the corners must stay free


def cover(picture: Picture, outlines: Iterable[Array]) -> None:
    """Tint where the target was seen, in place: the coverage picture."""
    quads = [np.round(quad * 16).astype(np.int32) for quad in outlines]
    if not quads:
        return
    tint = picture.copy()
    for quad in quads:
        cv2.fillConvexPoly(tint, quad, HAPPY, cv2.LINE_AA, 4)
    cv2.addWeighted(tint, 0.30, picture, 0.70, 0, picture)
    for quad in quads:
        cv2.polylines(picture, [quad], True, between(HAPPY, PAPER, 0.35), 1, cv2.LINE_AA, 4)


def trace(picture: Picture, outline: Array, scale: float) -> None:
    """Draw a line round what is seen now, in place."""
    quad = np.round(outline * 16).astype(np.int32)
    cv2.polylines(picture, [quad], True, PAPER, max(1, round(5 * scale)), cv2.LINE_AA, 4)
    cv2.polylines(picture, [quad], True, ACTION["walk"], max(1, round(3 * scale)), cv2.LINE_AA, 4)


def _rim(picture: Picture, shine: float, scale: float) -> None:
    height, width = picture.shape[:2]
    thick = round(2 + 14 * shine * scale)
    cv2.rectangle(picture, (0, 0), (width - 1, height - 1), HAPPY, 2 * thick)


def _arrow(canvas: Canvas, middle: tuple[float, float], wish: str) -> None:
    """Draw where the cube's front should look."""
    way = np.array({"up": (0, -1), "down": (0, 1), "left": (-1, 0), "right": (1, 0)}[wish[5:]])
    aside = np.array([-way[1], way[0]])
    tip = np.array(middle) + way * (88 if way[1] else 98)
    ends = [tip - 22 * way, tip]
    color = ACTION["kiss"]
    canvas.line(ends, color, 7)
    canvas.line([tip - 13 * way + 12 * aside, tip, tip - 13 * way - 12 * aside], color, 7)


def _ring(canvas: Canvas, middle: tuple[float, float], radius: float, moved: float) -> None:
    """Draw a ring that fills while the target is held still."""
    angles = np.linspace(0, 2 * math.pi, 72) - math.pi / 2
    ring = np.array(middle) + radius * np.stack([np.cos(angles), np.sin(angles)], axis=1)
    canvas.line(ring, RULE, 7, closed=True)
    canvas.line(ring[: max(2, round(72 * moved))], HAPPY, 7)


def _progress(advice: Advice, width: float, scale: float) -> Card:
    """Draw what is there already: tilts, places, distances, sides."""
    coverage = advice.coverage
    sides = [kind for kind in coverage.needed if kind.startswith("side ")]
    wide = 452.0 if sides else 352.0
    canvas = Canvas(wide, 132, scale)
    _tilts(canvas, coverage, 62, 52)
    _places(canvas, coverage, 172, 52)
    for number, kind in enumerate(("far", "near")):
        size = 11 + 9 * number
        _dot(canvas, 262 + 46 * number, 52, size, coverage.progress_of(kind))
    for number, kind in enumerate(sides):
        _dot(
            canvas, 364 + 28 * (number % 3), 39 + 27 * (number // 3), 9, coverage.progress_of(kind)
        )
    captions = [(62, "tipped"), (172, "everywhere"), (285, "far, near"), (392, "all sides")]
    for x, words in captions[: 4 if sides else 3]:
        canvas.text(x, 106, words, 15, QUIET, "middle")
    canvas.bar(18, 119, wide - 36, 6, RULE)
    canvas.bar(18, 119, max(6.0, (wide - 36) * coverage.progress), 6, HAPPY)
    return canvas.card((width - wide) / 2, HEIGHT - 156)


def _tilts(canvas: Canvas, coverage: ViewCoverage, x: float, y: float) -> None:
    for kind, way in (
        ("tilt up", (0, -1)),
        ("tilt down", (0, 1)),
        ("tilt left", (-1, 0)),
        ("tilt right", (1, 0)),
    ):
        ahead = np.array(way, float)
        aside = np.array([-ahead[1], ahead[0]])
        foot = np.array([x, y]) + 13 * ahead
        triangle = np.array([foot + 13 * aside, foot + 19 * ahead, foot - 13 * aside])
        fill(canvas, triangle, _green(coverage.progress_of(kind)))


def _places(canvas: Canvas, coverage: ViewCoverage, x: float, y: float) -> None:
    for kind, (across, down) in PLACES.items():
        middle = np.array([x + 31 * across, y + 19 * down])
        half = np.array([13.5, 8.5])
        corners = middle + half * np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)])
        fill(canvas, corners, _green(coverage.progress_of(kind)))


def _dot(canvas: Canvas, x: float, y: float, radius: float, share: float) -> None:
    canvas.disc(x, y, radius, _green(share))


def _green(share: float) -> tuple[int, int, int]:
    if share >= 1:
        return HAPPY
    return between(RULE, NEUTRAL, 0.75 * min(1.0, 1.5 * share))
