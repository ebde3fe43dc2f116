"""Cards that the player asks for, and those that a session shows for a while."""

from collections.abc import Sequence
from functools import lru_cache

from cubeling.app.pipeline.step import Rect
from cubeling.app.ui.canvas import PICTURE_HEIGHT, Canvas, Card, text_width, wrap_text
from cubeling.app.ui.cards.layout import CARD_GAP, HINT_ROOM, are_apart
from cubeling.app.ui.palette import ACTION_COLORS, INK, QUIET, RULE, Color
from cubeling.app.ui.playback.keys import KeyHelp, key_rows
from cubeling.app.ui.playback.status import EndCard

ACCENT = ACTION_COLORS["walk"]
"""Colour of what can be chosen or typed."""

PILL_HEIGHT, PILL_LINE, PILL_TEXT = 40.0, 26.0, 20.0
"""Height of a small card with one line, of each further line, and of the text."""

PILLS_TOP, PILL_GAP = 78.0, 8.0
"""Where small cards lie, below the hint, and the distance between them."""

COLUMNS = (("Play", "Recordings"), ("Keep", "View"))
"""The headings of the card of keys, by column."""

ROW_HEIGHT, HEADING_HEIGHT = 31.0, 44.0
CAP_SIZE = 17.0
ARROWS = {"←": -1, "→": 1}
"""Keys that the font cannot write, by their direction."""

KEYS_WIDTH, KEYS_TOP, KEYS_LEFT = 880.0, 26.0, (32.0, 508.0)


def draw_pills(
    pills: tuple[tuple[str, Color | None], ...],
    width: float,
    scale: float,
    taken: Sequence[Rect] = (),
) -> list[Card]:
    """Return small cards below each other: their words, and the colour of a disc or None.

    They are no wider than the room that other cards keep free for the hint: long words, such as a
    command with the name of a file, take two lines. They lie below what is `taken` in their way.
    """
    cards, y = [], PILLS_TOP
    for words, color in pills:
        lines = tuple(wrap_text(words, min(width - 60, HINT_ROOM - 70), PILL_TEXT))
        size, height = _pill_text(lines, width), PILL_HEIGHT + PILL_LINE * (len(lines) - 1)
        half = _pill_width(lines, color, size) / 2
        for box in sorted(taken, key=lambda box: box[1]):
            if not are_apart((width / 2 - half, y, width / 2 + half, y + height), [box]):
                y = box[3] + CARD_GAP
        cards.append(_pill(lines, color, y, width, scale))
        y += height + PILL_GAP
    return cards


def _pill_text(lines: tuple[str, ...], width: float) -> float:
    longest = max(text_width(line, PILL_TEXT) for line in lines)
    return PILL_TEXT * min(1.0, min(width - 60, HINT_ROOM - 70) / longest)


def _pill_width(lines: tuple[str, ...], color: Color | None, size: float) -> float:
    return max(text_width(line, size) for line in lines) + (42.0 if color is None else 68.0)


@lru_cache(maxsize=32)
def _pill(
    lines: tuple[str, ...], color: Color | None, y: float, width: float, scale: float
) -> Card:
    size = _pill_text(lines, width)
    left = 20.0 if color is None else 46.0
    card_width = _pill_width(lines, color, size)
    canvas = Canvas(card_width, PILL_HEIGHT + PILL_LINE * (len(lines) - 1), scale)
    if color is not None:
        canvas.disc(26, PILL_HEIGHT / 2, 8, color)
    for number, line in enumerate(lines):
        canvas.text(left, 27 + PILL_LINE * number, line, size, INK)
    return canvas.card((width - card_width) / 2, y)


@lru_cache(maxsize=4)
def draw_keys(width: float, scale: float) -> Card:
    """Return the card with all keys."""
    rows = key_rows()
    columns = [
        [row for group in groups for row in rows if row.group == group] for groups in COLUMNS
    ]
    height = KEYS_TOP + max(map(_column_height, columns)) + 44
    canvas = Canvas(KEYS_WIDTH, height, scale)
    for left, column in zip(KEYS_LEFT, columns, strict=True):
        _key_column(canvas, left, column)
    words = "Esc closes this card"
    canvas.text(KEYS_WIDTH / 2, height - 20, words, 16, QUIET, "middle")
    return canvas.card((width - KEYS_WIDTH) / 2, (PICTURE_HEIGHT - height) / 2, 0.97)


def _column_height(rows: list[KeyHelp]) -> float:
    return len({row.group for row in rows}) * HEADING_HEIGHT + len(rows) * ROW_HEIGHT


def _key_column(canvas: Canvas, left: float, rows: list[KeyHelp]) -> None:
    y, group = KEYS_TOP, ""
    caps = [list(dict.fromkeys(" ".join(row.keys).split())) for row in rows]
    words_left = left + max(sum(map(_key_width, each)) for each in caps) + 16
    for row, keys in zip(rows, caps, strict=True):
        if row.group != group:
            group = row.group
            canvas.text(left, y + 24, group, 22, INK)
            y += HEADING_HEIGHT
        x = left
        for key in keys:
            _draw_key(canvas, x, y + ROW_HEIGHT / 2 - 6, key)
            x += _key_width(key)
        canvas.text(words_left, y + 15, row.help, 17, INK)
        y += ROW_HEIGHT


def _key_width(key: str) -> float:
    """Return the width of a key with the space after it."""
    width = text_width(key, CAP_SIZE)
    return width + 8 if key == "…" else max(28.0, width + 16) + 6


def _draw_key(canvas: Canvas, x: float, y: float, key: str) -> None:
    """Draw a key with its left side at `x` and its middle at `y`."""
    width = _key_width(key) - 6
    if key == "…":
        canvas.text(x + 2, y + 5, key, CAP_SIZE, QUIET)
        return
    canvas.bar(x, y, width, 24, RULE)
    if key in ARROWS:
        _arrow(canvas, x + width / 2, y, ARROWS[key])
    else:
        canvas.text(x + width / 2, y + 6, key, CAP_SIZE, INK, "middle")


def _arrow(canvas: Canvas, x: float, y: float, side: int) -> None:
    canvas.line([[x - 6, y], [x + 6, y]], INK, 2)
    tip = x + 6 * side
    canvas.line([[tip - 4 * side, y - 4], [tip, y], [tip - 4 * side, y + 4]], INK, 2)


@lru_cache(maxsize=4)
def draw_ending(ending: EndCard, keys: str, width: float, scale: float) -> Card:
    """Return the card at the end of a recording; `keys` says what closes it, or is empty."""
    words = [ending.title, *(text for line in ending.lines for text in line), keys]
    card_width = max(360.0, *(text_width(each, 22) + 100 for each in words))
    height = 92.0 + 70.0 * len(ending.lines) + (36.0 if keys else 0.0)
    canvas = Canvas(card_width, height, scale)
    canvas.text(card_width / 2, 56, ending.title, 32, INK, "middle")
    y = 92.0
    for words_of_line, command in ending.lines:
        canvas.text(40, y + 20, words_of_line, 18, QUIET)
        canvas.text(40, y + 46, command, 22, ACCENT)
        y += 70.0
    if keys:
        canvas.text(card_width / 2, y + 18, keys, 17, QUIET, "middle")
    return canvas.card((width - card_width) / 2, (PICTURE_HEIGHT - height) / 2, 0.97)
