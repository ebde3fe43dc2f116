"""The first card: what can be played, with a picture of each scenario."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from importlib import resources

import cv2
import numpy as np
from numpy.typing import NDArray

from cubeling.app.errors import AppError
from cubeling.app.pipeline.registry import scenario_summary
from cubeling.app.ui.canvas import Canvas, Card, text_width, wrap_text
from cubeling.app.ui.palette import INK, PAPER, QUIET, RULE, between
from cubeling.app.ui.playback.cards import ACCENT, LARGE_CARD_MARGIN, centre, large_card

TITLE = "What would you like to play?"
HELP = "Press a number, or click  ·  Esc closes  ·  0 brings it back"
SIDE, GAP, TOP, BOTTOM = 28.0, 20.0, 74.0, 52.0
NAME_HEIGHT, SUMMARY_SIZE, SUMMARY_LINE = 44.0, 15.0, 20.0
"""Height of a name under a picture, size of a summary's letters, and distance of its lines."""

MAX_LINES = 4
"""Lines of a summary that are shown: those of the bundled scenarios are whole."""

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
        layout = _Layout.of(self._scenarios, width)
        left, top, scale = centre(layout.size, width)
        for place in range(len(self._scenarios)):
            tile_x, tile_y = layout.corner(place)
            inside_x, inside_y = (x - left) / scale - tile_x, (y - top) / scale - tile_y
            if 0.0 <= inside_x <= layout.tile and 0.0 <= inside_y <= layout.tile_height:
                return place + 1
        return None


@dataclass(frozen=True)
class _Layout:
    """Where the pictures are on the card, and what is under them."""

    tile: float
    """Width of a picture."""

    columns: int
    """Pictures beside each other."""

    summaries: tuple[tuple[str, ...], ...]
    """What the scenarios are, in lines."""

    @classmethod
    @lru_cache(maxsize=2)
    def of(cls, scenarios: tuple[str, ...], width: float) -> "_Layout":
        count = len(scenarios)
        columns = 2 if count <= FEW else 3
        room = (width - 2 * LARGE_CARD_MARGIN - 2 * SIDE - (columns - 1) * GAP) / columns
        tile = min(WIDE_TILE if count <= FEW else TILE, room)
        return cls(tile, columns, tuple(_summary_lines(each, tile - 8) for each in scenarios))

    @property
    def tile_height(self) -> float:
        lines = max(map(len, self.summaries), default=0)
        return self.tile * 9 / 16 + NAME_HEIGHT + lines * SUMMARY_LINE

    @property
    def size(self) -> tuple[float, float]:
        rows = math.ceil(len(self.summaries) / self.columns)
        wide = 2 * SIDE + self.columns * self.tile + (self.columns - 1) * GAP
        return wide, TOP + rows * self.tile_height + BOTTOM

    def corner(self, place: int) -> tuple[float, float]:
        """Return the top left corner of a picture on the card."""
        row, column = divmod(place, self.columns)
        return SIDE + column * (self.tile + GAP), TOP + row * self.tile_height


def _summary_lines(name: str, width: float) -> tuple[str, ...]:
    lines = wrap_text(summary_of(name), width, SUMMARY_SIZE)
    if len(lines) > MAX_LINES:
        lines[MAX_LINES - 1 :] = [f"{lines[MAX_LINES - 1]} …"]
    return tuple(lines)


@lru_cache(maxsize=2)
def _draw(scenarios: tuple[str, ...], present: str, width: float, scale: float) -> Card:
    layout = _Layout.of(scenarios, width)
    wide, high = layout.size
    tile = layout.tile

    def draw(canvas: Canvas) -> None:
        size = min(30.0, 30.0 * (wide - 2 * SIDE) / text_width(TITLE, 30.0))
        canvas.text(wide / 2, 50, TITLE, size, INK, "middle")
        for place, (name, lines) in enumerate(zip(scenarios, layout.summaries, strict=True)):
            x, y = layout.corner(place)
            canvas.picture(x, y, scenario_picture(name, round(tile * canvas.scale)), 12)
            canvas.disc(x + 24, y + 24, 17, ACCENT)
            canvas.text(x + 24, y + 31, f"{place + 1}", 20, PAPER, "middle")
            y += tile * 9 / 16
            canvas.text(x + 4, y + 25, name, 20, ACCENT if name == present else INK)
            for number, line in enumerate(lines):
                baseline = y + 46 + number * SUMMARY_LINE
                canvas.text(x + 4, baseline, line, SUMMARY_SIZE, QUIET)
        size = min(16.0, 16.0 * (wide - 2 * SIDE) / text_width(HELP, 16.0))
        canvas.text(wide / 2, high - 20, HELP, size, QUIET, "middle")

    return large_card((wide, high), width, scale, draw)


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
