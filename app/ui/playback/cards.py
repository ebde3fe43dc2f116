"""Cards that the player asks for, and those that a session shows for a while."""

from collections.abc import Callable, Sequence
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
"""The headings of the card of keys, by column; in a narrow picture they are one column."""

ROW_HEIGHT, HEADING_HEIGHT = 31.0, 44.0
WORDS_SIZE, WORDS_ROOM, WORDS_LINE = 17.0, 300.0, 20.0
"""Size of what a key does, its width, and the height of each further line."""

CAP_SIZE = 17.0
ARROWS = {"←": -1, "→": 1}
"""Keys that the font cannot write, by their direction."""

KEYS_TOP, KEYS_BOTTOM, KEYS_SIDE, COLUMN_GAP = 26.0, 44.0, 32.0, 28.0
WORDS_GAP = 16.0
"""Between the keys of a column and what they do."""

HINTED_WIDER = 1.04
"""Small letters are hinted: lines of them are up to so much wider than `text_width` says."""

LARGE_CARD_MARGIN = 10.0
"""Least distance of a large card from the edges of the picture."""


def centre(size: tuple[float, float], width: float) -> tuple[float, float, float]:
    """Return left and top edge of a large card in the middle of a picture, and its scale.

    A card that does not fit is drawn smaller.

    >>> centre((880.0, 500.0), 1280.0)
    (200.0, 110.0, 1.0)
    >>> centre((880.0, 500.0), 460.0)
    (10.0, 235.0, 0.5)
    """
    wide, high = size
    scale = min(
        1.0, (width - 2 * LARGE_CARD_MARGIN) / wide, (PICTURE_HEIGHT - 2 * LARGE_CARD_MARGIN) / high
    )
    return (width - scale * wide) / 2, (PICTURE_HEIGHT - scale * high) / 2, scale


def large_card(
    size: tuple[float, float], width: float, scale: float, draw: Callable[[Canvas], None]
) -> Card:
    """Return a card in the middle of the picture; `draw` draws it as if it had the room."""
    left, top, smaller = centre(size, width)
    canvas = Canvas(*size, scale * smaller)
    draw(canvas)
    return canvas.card(left / smaller, top / smaller, 0.97)


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
    one_column = [row for column in columns for row in column]
    shapes = (columns, [one_column])
    chosen = max(shapes, key=lambda each: centre(_keys_size(each), width)[2])
    size = _keys_size(chosen)

    def draw(canvas: Canvas) -> None:
        left = KEYS_SIDE
        for column in chosen:
            _key_column(canvas, left, column)
            left += _column_size(column)[0] + COLUMN_GAP
        words = "Esc closes this card"
        canvas.text(size[0] / 2, size[1] - 20, words, 16, QUIET, "middle")

    return large_card(size, width, scale, draw)


def _keys_size(columns: Sequence[list[KeyHelp]]) -> tuple[float, float]:
    wide, high = zip(*map(_column_size, columns), strict=True)
    gaps = (len(columns) - 1) * COLUMN_GAP
    return 2 * KEYS_SIDE + sum(wide) + gaps, KEYS_TOP + max(high) + KEYS_BOTTOM


def _column_size(rows: list[KeyHelp]) -> tuple[float, float]:
    lines = [wrap_text(row.help, WORDS_ROOM, WORDS_SIZE) for row in rows]
    longest = max(text_width(line, WORDS_SIZE) for each in lines for line in each)
    high = len({row.group for row in rows}) * HEADING_HEIGHT + len(rows) * ROW_HEIGHT
    return _caps_width(rows) + longest * HINTED_WIDER, high + sum(
        len(each) - 1 for each in lines
    ) * WORDS_LINE


def _caps(row: KeyHelp) -> list[str]:
    """Return what is drawn as keys: "Shift", "←" and "→" for "Shift ←" and "Shift →"."""
    return list(dict.fromkeys(" ".join(row.keys).split()))


def _caps_width(rows: list[KeyHelp]) -> float:
    return max(sum(map(_key_width, _caps(row))) for row in rows) + WORDS_GAP


def _key_column(canvas: Canvas, left: float, rows: list[KeyHelp]) -> None:
    y, group = KEYS_TOP, ""
    words_left = left + _caps_width(rows)
    for row in rows:
        if row.group != group:
            group = row.group
            canvas.text(left, y + 24, group, 22, INK)
            y += HEADING_HEIGHT
        x = left
        for key in _caps(row):
            _draw_key(canvas, x, y + ROW_HEIGHT / 2 - 6, key)
            x += _key_width(key)
        lines = wrap_text(row.help, WORDS_ROOM, WORDS_SIZE)
        for number, line in enumerate(lines):
            canvas.text(words_left, y + 15 + number * WORDS_LINE, line, WORDS_SIZE, INK)
        y += ROW_HEIGHT + (len(lines) - 1) * WORDS_LINE


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
    room = max(360.0, width - 2 * LARGE_CARD_MARGIN) - 100
    lines = [(words, wrap_text(command, room, 22)) for words, command in ending.lines]
    texts = [ending.title, *(text for words, command in lines for text in (words, *command)), keys]
    card_width = max(360.0, *(text_width(each, 22) + 100 for each in texts))
    height = 92.0 + sum(42.0 + 28.0 * len(command) for _, command in lines) + 36.0 * bool(keys)

    def draw(canvas: Canvas) -> None:
        canvas.text(card_width / 2, 56, ending.title, 32, INK, "middle")
        y = 92.0
        for words, command in lines:
            canvas.text(40, y + 20, words, 18, QUIET)
            for number, text in enumerate(command):
                canvas.text(40, y + 46 + 28 * number, text, 22, ACCENT)
            y += 42.0 + 28.0 * len(command)
        if keys:
            canvas.text(card_width / 2, y + 18, keys, 17, QUIET, "middle")

    return large_card((card_width, height), width, scale, draw)
