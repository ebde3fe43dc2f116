"""The strip under the picture of a recording: where it is, and what happened when."""

from dataclasses import replace
from functools import lru_cache

import numpy as np

from cubeling.app.ui.canvas import PICTURE_HEIGHT, Canvas, Card, text_width
from cubeling.app.ui.palette import ACTION_COLORS, ANGRY, INK, PAPER, QUIET, RULE, Color, between
from cubeling.app.ui.playback.status import PlaybackMark, Position

STRIP_HEIGHT = 56.0
"""Height of the strip, in units of the canvas."""

TRACK_LEFT, TRACK_RIGHT = 214.0, 36.0
"""Distance of the track's ends from the sides of the strip."""

LETTER_GAP = 0.6
"""Distance between the letters of the time."""

TRACK_Y = STRIP_HEIGHT / 2
BUTTON_X = 36.0
"""Centers of the track and of the button that pauses."""

MARK_REACH = 6.0
"""How far from a mark the mouse points to it."""

PLAYED = ACTION_COLORS["walk"]
"""Colour of the part of the track that lies behind."""

MARK_COLORS: dict[str, Color] = {
    "placed": ACTION_COLORS["stand"],
    "start over": ANGRY,
    "camera": QUIET,
    "paused": QUIET,
    "resumed": QUIET,
}
"""Colours of the marks by how their event begins; others are gestures."""


def strip_of(position: Position, paused: bool, width: float, scale: float) -> Card:
    """Return the strip under a picture; `width` in units of the canvas.

    It changes as often as the time on it does: a tenth of a second is less than a pixel or two.
    """
    return _strip(replace(position, now=int(10 * position.now + 1e-6) / 10), paused, width, scale)


@lru_cache(maxsize=2)
def _strip(position: Position, paused: bool, width: float, scale: float) -> Card:
    canvas = _background(position.marks, position.length, width, scale).copy()
    _button(canvas, paused)
    shown = position.now if position.target is None else position.target
    x = 64.0
    for letter in clock_time(shown):  # each is drawn once: the time seldom is the same again
        canvas.text(x, TRACK_Y + 6, letter, 19, INK)
        x += text_width(letter, 19) + LETTER_GAP
    canvas.text(
        x + 6,
        TRACK_Y + 6,
        f"/ {clock_time(position.length)}",
        19,
        QUIET,
    )
    for left, right, color in (
        (0.0, position.length, RULE),
        (position.start, position.end, between(RULE, PLAYED, 0.25)),
        (position.start, min(position.now, position.end), PLAYED),
    ):
        ends = [_x(left, position.length, width), _x(right, position.length, width)]
        if ends[1] > ends[0]:
            canvas.line([[ends[0], TRACK_Y], [ends[1], TRACK_Y]], color, 8)
    now = _x(position.now, position.length, width)
    if position.target is not None:
        target = _x(position.target, position.length, width)
        canvas.disc(target, TRACK_Y, 10, PLAYED)
        canvas.disc(target, TRACK_Y, 7, PAPER)
    canvas.disc(now, TRACK_Y, 10, PAPER)
    canvas.disc(now, TRACK_Y, 8, PLAYED)
    return canvas.strip(PICTURE_HEIGHT)


def position_at(x: float, position: Position, width: float) -> float:
    """Return the time under the mouse at `x`, within the part that is played [s]."""
    share = (x - TRACK_LEFT) / (width - TRACK_LEFT - TRACK_RIGHT)
    return min(max(share * position.length, position.start), position.end)


def is_on_button(x: float) -> bool:
    """Return whether `x` is on the button that pauses, rather than on the track."""
    return x < TRACK_LEFT - 20


@lru_cache(maxsize=2)
def draw_pointer(x: float, position: Position, width: float, scale: float) -> Card:
    """Return the label of the place under the mouse, above the strip: its time, or its mark."""
    time = position_at(x, position, width)
    words = clock_time(time)
    for mark in position.marks:
        if abs(_x(mark.position, position.length, width) - x) <= MARK_REACH:
            words = f"{clock_time(mark.position)}  {mark.event}"
    card_width = text_width(words, 18) + 28
    canvas = Canvas(card_width, 34, scale)
    canvas.text(14, 23, words, 18, INK)
    left = min(max(x - card_width / 2, 4.0), width - card_width - 4.0)
    return canvas.card(left, PICTURE_HEIGHT - 40)


def clock_time(seconds: float) -> str:
    """Return a time as a player of videos shows it.

    >>> clock_time(5.04), clock_time(75.96), clock_time(3725.0)
    ('0:05.0', '1:15.9', '1:02:05.0')
    """
    tenths = int(max(0.0, seconds) * 10 + 1e-6)
    minutes, rest = divmod(tenths, 600)
    hours, minutes = divmod(minutes, 60)
    start = f"{hours}:{minutes:02}" if hours else f"{minutes}"
    return f"{start}:{rest // 10:02}.{rest % 10}"


def _x(time: float, length: float, width: float) -> float:
    """Return where a time is on the track."""
    share = min(max(time / length, 0.0), 1.0) if length > 0 else 0.0
    return TRACK_LEFT + share * (width - TRACK_LEFT - TRACK_RIGHT)


@lru_cache(maxsize=4)
def _background(
    marks: tuple[PlaybackMark, ...], length: float, width: float, scale: float
) -> Canvas:
    """Draw what does not change while a recording plays."""
    canvas = Canvas(width, STRIP_HEIGHT, scale)
    for mark in marks:
        x = _x(mark.position, length, width)
        color = next(
            (color for start, color in MARK_COLORS.items() if mark.event.startswith(start)),
            ACTION_COLORS["run"],
        )
        canvas.line([[x, TRACK_Y - 19], [x, TRACK_Y - 11]], color, 4)
    return canvas


def _button(canvas: Canvas, paused: bool) -> None:
    canvas.disc(BUTTON_X, TRACK_Y, 18, INK)
    if paused:
        triangle = np.array([[-6.0, -9.0], [10.0, 0.0], [-6.0, 9.0]])
        canvas.fill(triangle + (BUTTON_X, TRACK_Y), PAPER)
    else:
        for side in (-5.0, 5.0):
            canvas.line([[BUTTON_X + side, TRACK_Y - 6], [BUTTON_X + side, TRACK_Y + 6]], PAPER, 5)
