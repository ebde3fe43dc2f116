"""The coach over the picture: the next move, an animation of it, and the progress so far.

Everything is shown as it looks in the picture: left is left on the screen.
"""

import math
from collections.abc import Iterable

import cv2
import numpy as np
from numpy.typing import NDArray

from cubeling.app.ui.calibration.orientation_icons import draw_board, draw_cube, draw_screen
from cubeling.app.ui.calibration.session import Advice
from cubeling.app.ui.canvas import PICTURE_HEIGHT, Canvas, Card, text_width
from cubeling.app.ui.palette import (
    ACTION_COLORS,
    HAPPY,
    INK,
    NEUTRAL,
    PAPER,
    QUIET,
    RULE,
    Color,
    between,
)
from cubeling.tracking.calibration import ViewCoverage

Picture = NDArray[np.uint8]
Array = NDArray[np.float64]

FLASH_S = 0.25
"""Time for which the picture's border flashes when a view was taken [s]."""

ANIMATION_PERIOD_S = 1.8
"""Period of the animation [s]."""

TILT_RAD = math.radians(34)
"""Angle by which the animation tilts the cube."""

ICON_ROTATION = np.array([-0.35, 0.4, 0.0])
"""Rotation vector of a target that does not tilt, so that three faces are visible."""

REQUEST_SENTENCES = {
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
    "top left": "Move it to the top left corner",
    "top right": "Move it to the top right corner",
    "bottom left": "Move it to the bottom left corner",
    "bottom right": "Move it to the bottom right corner",
    "middle": "Move it to the middle",
}
"""What the coach says for each request; {} is the target."""

TILT_DIRECTIONS = {
    "tilt up": (0, -1),
    "tilt down": (0, 1),
    "tilt left": (-1, 0),
    "tilt right": (1, 0),
}
"""Where the cube's front should look in the picture (x right, y down)."""

PICTURE_PLACES = {
    "top left": (-1, -1),
    "top right": (1, -1),
    "bottom left": (-1, 1),
    "bottom right": (1, 1),
    "middle": (0, 0),
}
"""Where to hold the target, from the middle of the picture (x right, y down)."""


def words_of(request: str, target: str) -> str:
    """Return a request as a sentence; `target` is "cube" or "board".

    >>> words_of("tilt up", "cube")
    'Tip the cube up'
    """
    if request.startswith("side "):
        return "Turn it over: show me another side"
    return REQUEST_SENTENCES[request].format(target)


class CoachView:
    """Draws the coach over a sequence of pictures; `target` is "cube" or "board"."""

    def __init__(self, target: str) -> None:
        self._target = target
        self._taken_at = -math.inf
        self._on_right = False
        self._request_since: tuple[str, float] = ("", 0.0)

    def draw(self, picture: Picture, timestamp: float, advice: Advice) -> Picture:
        """Draw on the picture (H, W, 3), in place, and return it."""
        if advice.taken:
            self._taken_at = timestamp
        if self._request_since[0] != advice.request:
            self._request_since = advice.request, timestamp
        scale = picture.shape[0] / PICTURE_HEIGHT
        width = picture.shape[1] / scale
        draw_coverage(picture, advice.covered)
        for outline in advice.outlines:
            draw_outline(picture, outline, scale)
        flash = 1 - (timestamp - self._taken_at) / FLASH_S
        if flash > 0:
            height, across = picture.shape[:2]
            thickness = 2 * round(2 + 14 * flash * scale)
            cv2.rectangle(picture, (0, 0), (across - 1, height - 1), HAPPY, thickness)
        phase = (timestamp - self._request_since[1]) / ANIMATION_PERIOD_S % 1.0
        left = self._animation_left(advice, width, scale)
        self._hint(advice, width, scale).blend_over(picture)
        self._animation(advice.request, phase, scale, left).blend_over(picture)
        _progress(advice, width, scale).blend_over(picture)
        return picture

    def _hint(self, advice: Advice, width: float, scale: float) -> Card:
        words = words_of(advice.request, self._target)
        card_width = text_width(words, 34) + 72
        canvas = Canvas(card_width, 64, scale)
        good = advice.request in ("still", "done", "")
        color = between(HAPPY, INK, 0.25) if good else INK
        canvas.text(card_width / 2, 43.5, words, 34, color, "middle")
        return canvas.card((width - card_width) / 2, 22)

    def _animation_left(self, advice: Advice, width: float, scale: float) -> float:
        """Return the left edge of the animation's card, which moves away from the target."""
        for outline in advice.outlines:
            x, y = outline.T / scale
            top, bottom = (PICTURE_HEIGHT - 240) / 2, (PICTURE_HEIGHT + 240) / 2
            beside = y.max() > top and y.min() < bottom
            if beside and (x.max() > width - 274 if self._on_right else x.min() < 274):
                self._on_right = not self._on_right
        return width - 254 if self._on_right else 24.0

    def _animation(self, request: str, phase: float, scale: float, left: float) -> Card:
        canvas = Canvas(230, 200, scale)
        draw = draw_board if self._target == "board" else draw_cube
        # Forth and back, with a pause at both ends.
        share = float(np.clip(0.5 - 0.75 * math.cos(2 * math.pi * phase), 0, 1))
        middle = (115.0, 100.0)
        if request in TILT_DIRECTIONS:
            x, y = TILT_DIRECTIONS[request]
            draw(canvas, middle, 44.0, TILT_RAD * share * np.array([y, -x, 0.0]))
            _arrow(canvas, middle, request)
        elif request in PICTURE_PLACES or request == "show":
            x, y = PICTURE_PLACES.get(request, (0, 0))
            start = (-1.9, 0.0) if request == "show" else (-x * 0.5, -y * 0.5)
            at = (start[0] + (x - start[0]) * share, start[1] + (y - start[1]) * share)
            draw_screen(canvas, middle, (190.0, 120.0))
            draw(canvas, (115 + 66 * at[0], 100 + 34 * at[1]), 17.0, ICON_ROTATION)
        elif request in ("near", "far"):
            size = 22 + 34 * (share if request == "near" else 1 - share)
            draw(canvas, middle, size, ICON_ROTATION)
        elif request in ("done", ""):
            canvas.disc(*middle, 62, HAPPY)
            canvas.line([(84, 102), (106, 125), (147, 76)], PAPER, 14)
        elif request == "still":
            draw(canvas, middle, 44.0, ICON_ROTATION)
            _ring(canvas, middle, 84.0, phase)
        else:
            draw(canvas, middle, 44.0, np.array([0.0, math.pi / 2 * share, 0.0]))
        return canvas.card(left, (PICTURE_HEIGHT - 200) / 2)  # the picture's corners stay free


def draw_coverage(picture: Picture, outlines: Iterable[Array]) -> None:
    """Tint the areas where the target was seen, in place."""
    quads = [np.round(quad * 16).astype(np.int32) for quad in outlines]
    if not quads:
        return
    tint = picture.copy()
    for quad in quads:
        cv2.fillConvexPoly(tint, quad, HAPPY, cv2.LINE_AA, 4)
    cv2.addWeighted(tint, 0.30, picture, 0.70, 0, picture)
    for quad in quads:
        cv2.polylines(picture, [quad], True, between(HAPPY, PAPER, 0.35), 1, cv2.LINE_AA, 4)


def draw_outline(picture: Picture, outline: Array, scale: float) -> None:
    """Draw the outline of the target in this frame, in place."""
    quad = np.round(outline * 16).astype(np.int32)
    cv2.polylines(picture, [quad], True, PAPER, max(1, round(5 * scale)), cv2.LINE_AA, 4)
    cv2.polylines(
        picture, [quad], True, ACTION_COLORS["walk"], max(1, round(3 * scale)), cv2.LINE_AA, 4
    )


def _arrow(canvas: Canvas, middle: tuple[float, float], request: str) -> None:
    """Draw an arrow to where the cube's front should look."""
    direction = np.array(TILT_DIRECTIONS[request])
    aside = np.array([-direction[1], direction[0]])
    tip = np.array(middle) + direction * (88 if direction[1] else 98)
    ends = [tip - 22 * direction, tip]
    color = ACTION_COLORS["kiss"]
    canvas.line(ends, color, 7)
    back = tip - 13 * direction
    canvas.line([back + 12 * aside, tip, back - 12 * aside], color, 7)


def _ring(canvas: Canvas, middle: tuple[float, float], radius: float, share: float) -> None:
    """Draw a ring that fills up: hold still."""
    angles = np.linspace(0, 2 * math.pi, 72) - math.pi / 2
    ring = np.array(middle) + radius * np.stack([np.cos(angles), np.sin(angles)], axis=1)
    canvas.line(ring, RULE, 7, closed=True)
    canvas.line(ring[: max(2, round(72 * share))], HAPPY, 7)


def _progress(advice: Advice, width: float, scale: float) -> Card:
    """Draw which views exist: tilts, places, distances, sides."""
    coverage = advice.coverage
    sides = [kind for kind in coverage.needed if kind.startswith("side ")]
    card_width = 452.0 if sides else 352.0
    canvas = Canvas(card_width, 132, scale)
    _tilts(canvas, coverage, 62, 52)
    _places(canvas, coverage, 172, 52)
    for number, kind in enumerate(("far", "near")):
        color = _progress_color(coverage, kind)
        canvas.disc(262 + 46 * number, 52, 11 + 9 * number, color)
    for number, kind in enumerate(sides):
        x, y = 364 + 28 * (number % 3), 39 + 27 * (number // 3)
        canvas.disc(x, y, 9, _progress_color(coverage, kind))
    captions = [(62, "tipped"), (172, "everywhere"), (285, "far, near"), (392, "all sides")]
    for x, words in captions[: 4 if sides else 3]:
        canvas.text(x, 106, words, 15, QUIET, "middle")
    canvas.bar(18, 119, card_width - 36, 6, RULE)
    canvas.bar(18, 119, max(6.0, (card_width - 36) * coverage.progress), 6, HAPPY)
    return canvas.card((width - card_width) / 2, PICTURE_HEIGHT - 156)


def _tilts(canvas: Canvas, coverage: ViewCoverage, x: float, y: float) -> None:
    for kind, direction in TILT_DIRECTIONS.items():
        ahead = np.array(direction, float)
        aside = np.array([-ahead[1], ahead[0]])
        foot = np.array([x, y]) + 13 * ahead
        triangle = np.array([foot + 13 * aside, foot + 19 * ahead, foot - 13 * aside])
        canvas.fill(triangle, _progress_color(coverage, kind))


def _places(canvas: Canvas, coverage: ViewCoverage, x: float, y: float) -> None:
    for kind, (across, down) in PICTURE_PLACES.items():
        middle = np.array([x + 31 * across, y + 19 * down])
        half = np.array([13.5, 8.5])
        corners = middle + half * np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)])
        canvas.fill(corners, _progress_color(coverage, kind))


def _progress_color(coverage: ViewCoverage, kind: str) -> Color:
    share = coverage.progress_of(kind)
    if share >= 1:
        return HAPPY
    return between(RULE, NEUTRAL, 0.75 * min(1.0, 1.5 * share))
