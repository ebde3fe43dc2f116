"""Labels beside the characters of a cast: who it is, its mood, and whether it speaks."""

from functools import lru_cache

from cubeling.app.ui.canvas import Canvas, can_be_written, text_width
from cubeling.app.ui.cards.faces import draw_face
from cubeling.app.ui.palette import INK, QUIET

LABEL_HEIGHT = 40.0
FACE_RADIUS, FACE_X = 12.5, 21.0
"""Radius of the face that shows the mood, and where it is on the label."""

TEXT_X, TEXT_SIZE, LETTERS = 40.0, 18.0, 14
"""Left end and height of the name, and how many of its letters are shown."""

SPEAKING_WIDTH = 30.0
"""Room for the three dots of one that speaks."""

MOOD_STEPS = 8
"""Faces between neutral and the greatest mood: a label is drawn again when another one fits."""


def label(name: str, mood: float, speaks: bool, scale: float) -> Canvas:
    """Return the label of a character in a mood from angry, −1, over neutral to happy, 1."""
    return _label(name, round(mood * MOOD_STEPS) / MOOD_STEPS, speaks, scale)


@lru_cache(maxsize=64)
def _label(name: str, mood: float, speaks: bool, scale: float) -> Canvas:
    words = readable(name)
    text = text_width(words, TEXT_SIZE)
    canvas = Canvas(TEXT_X + text + 16.0 + SPEAKING_WIDTH * speaks, LABEL_HEIGHT, scale)
    draw_face(canvas, FACE_X, LABEL_HEIGHT / 2, FACE_RADIUS, mood, crest=False)
    canvas.text(TEXT_X, 26.0, words, TEXT_SIZE, INK)
    for dot in range(3 * speaks):
        canvas.disc(TEXT_X + text + 12.0 + 8.5 * dot, LABEL_HEIGHT / 2 + 2.0, 2.8, QUIET)
    return canvas


def readable(name: str) -> str:
    """Return a name of the cast as a person reads it.

    >>> readable("vleo_2")
    'Vleo 2'
    """
    shown = name.replace("_", " ")[:LETTERS]
    return f"{shown[:1].upper()}{shown[1:]}" if can_be_written(shown) else ""
