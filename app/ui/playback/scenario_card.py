"""The first card: what can be played, with a picture of each scenario."""

import math
from collections.abc import Sequence
from functools import lru_cache
from importlib import resources

import cv2
import numpy as np
from numpy.typing import NDArray

from cubeling.app.errors import AppError
from cubeling.app.pipeline.registry import scenario_summary
from cubeling.app.ui.canvas import PICTURE_HEIGHT, Canvas, Card, text_width, wrap_text
from cubeling.app.ui.palette import INK, PAPER, QUIET, RULE, between
from cubeling.app.ui.playback.cards import ACCENT

TITLE = "What would you like to play?"
HELP = "Press a number, or click  ·  Esc closes  ·  0 brings it back"
SIDE, GAP, TOP, BOTTOM = 28.0, 20.0, 74.0, 52.0
TEXT_HEIGHT, SUMMARY_SIZE, SUMMARY_LINE = 84.0, 15.0, 20.0
"""Height of the text under a picture, size of a summary's letters, and distance of its lines."""

MAX_LINES = 2
"""Lines of a summary that are shown."""

FEW, WIDE_TILE, TILE = 4, 300.0, 224.0
"""So many scenarios are shown with wide pictures in two columns, more in three."""

MAX_SCENARIOS = 9
"""Those that have a number."""


class ScenarioCard:
    """The scenarios in columns. Lengths are in units of the canvas.

    `scenarios` are their names, in the order of the keys 1 to 9.
    """

    def __init__(self, scenarios: Sequence[str]) -> None:
        self._scenarios = tuple(scenarios[:MAX_SCENARIOS])

    def draw(self, present: str, width: float, scale: float) -> Card:
        """Return the card, on which the scenario that plays is marked."""
        return _draw(self._scenarios, present, width, scale)

    def click(self, x: float, y: float, width: float) -> int | None:
        """Return the number of the scenario at a place of the picture, from 1; None if none is."""
        tile, columns, (left, top, _, _) = _layout(len(self._scenarios), width)
        for place in range(len(self._scenarios)):
            tile_x, tile_y = _corner(place, tile, columns)
            inside_x, inside_y = x - left - tile_x, y - top - tile_y
            if 0.0 <= inside_x <= tile and 0.0 <= inside_y <= _height(tile):
                return place + 1
        return None


def _height(tile: float) -> float:
    return tile * 9 / 16 + TEXT_HEIGHT


def _corner(place: int, tile: float, columns: int) -> tuple[float, float]:
    """Return the top left corner of a tile on the card."""
    row, column = divmod(place, columns)
    return SIDE + column * (tile + GAP), TOP + row * _height(tile)


def _layout(count: int, width: float) -> tuple[float, int, tuple[float, float, float, float]]:
    """Return the width of a tile, the columns, and left, top, width and height of the card."""
    columns = 2 if count <= FEW else 3
    room = (width - 2 * GAP - 2 * SIDE - (columns - 1) * GAP) / columns
    tile = min(WIDE_TILE if count <= FEW else TILE, room)
    rows = math.ceil(count / columns)
    wide = 2 * SIDE + columns * tile + (columns - 1) * GAP
    high = TOP + rows * _height(tile) + BOTTOM
    return tile, columns, ((width - wide) / 2, (PICTURE_HEIGHT - high) / 2, wide, high)


@lru_cache(maxsize=2)
def _draw(scenarios: tuple[str, ...], present: str, width: float, scale: float) -> Card:
    tile, columns, (left, top, wide, high) = _layout(len(scenarios), width)
    canvas = Canvas(wide, high, scale)
    size = min(30.0, 30.0 * (wide - 2 * SIDE) / text_width(TITLE, 30.0))
    canvas.text(wide / 2, 50, TITLE, size, INK, "middle")
    for place, name in enumerate(scenarios):
        x, y = _corner(place, tile, columns)
        canvas.picture(x, y, scenario_picture(name, round(tile * scale)), 12)
        canvas.disc(x + 24, y + 24, 17, ACCENT)
        canvas.text(x + 24, y + 31, f"{place + 1}", 20, PAPER, "middle")
        y += tile * 9 / 16
        canvas.text(x + 4, y + 25, name, 20, ACCENT if name == present else INK)
        lines = wrap_text(summary_of(name), tile - 8, SUMMARY_SIZE)
        if len(lines) > MAX_LINES:
            lines[MAX_LINES - 1 :] = [f"{lines[MAX_LINES - 1]} …"]
        for number, line in enumerate(lines):
            baseline = y + 46 + number * SUMMARY_LINE
            canvas.text(x + 4, baseline, line, SUMMARY_SIZE, QUIET)
    size = min(16.0, 16.0 * (wide - 2 * SIDE) / text_width(HELP, 16.0))
    canvas.text(wide / 2, high - 20, HELP, size, QUIET, "middle")
    return canvas.card(left, top, 0.97)


def summary_of(name: str) -> str:
    """Return what a scenario is; that of another package may be broken."""
    try:
        return scenario_summary(name)
    except AppError:
        return "it cannot be used: choose it to see why"


def scenario_picture(name: str, width: int) -> NDArray[np.uint8]:
    """Return the picture of a scenario, (9/16 width, width, 3) BGR; that of others is plain."""
    height = round(width * 9 / 16)
    folder = resources.files("cubeling.app.ui.playback") / "scenario_pictures"
    file = folder / f"{name}.jpg"
    # A file of rules has a path for a name.
    if name.isidentifier() and file.is_file():
        data = np.frombuffer(file.read_bytes(), np.uint8)
        image = cv2.imdecode(data, cv2.IMREAD_COLOR)
        assert image is not None, "bundled pictures can be read"
        small = cv2.resize(image, (width, height), interpolation=cv2.INTER_AREA)
        return np.asarray(small, np.uint8)
    plain = Canvas(width, height, 1.0)
    plain.color[:] = between(RULE, ACCENT, 0.12)
    plain.text(width / 2, height * 0.62, name[:1].upper(), height * 0.4, PAPER, "middle")
    return plain.color
