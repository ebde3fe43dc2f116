"""The colours of the user interface, in BGR order as OpenCV takes them."""

Color = tuple[int, int, int]


def bgr(code: str) -> Color:
    """Return "#rrggbb" as (blue, green, red).

    >>> bgr("#ff8000")
    (0, 128, 255)
    """
    red, green, blue = (int(code[place : place + 2], 16) for place in (1, 3, 5))
    return blue, green, red


def between(first: Color, second: Color, share: float) -> Color:
    """Mix two colours; `share` 0 gives the first, 1 the second."""
    mixed = [round(a + (b - a) * share) for a, b in zip(first, second, strict=True)]
    return mixed[0], mixed[1], mixed[2]


PAPER = bgr("#fffaf0")
INK = bgr("#2b3345")
QUIET = bgr("#8a8fa0")
RULE = bgr("#e6dece")

ANGRY = bgr("#e5533d")
NEUTRAL = bgr("#f2b63c")
HAPPY = bgr("#43b36b")

ROBOT_COLOR = bgr("#56b4e9")
"""What a robot shows, in plots."""

ACTION_COLORS: dict[str, Color] = {
    "idle": bgr("#4aa3a2"),
    "stand": bgr("#4aa3a2"),
    "walk": bgr("#3a7bd5"),
    "run": bgr("#8b5bd6"),
    "hop": bgr("#3a7bd5"),
    "kiss": bgr("#e8557f"),
    "shout": bgr("#f0742b"),
    "reach": bgr("#d98a1f"),
    "stretch": bgr("#d98a1f"),
    "point": bgr("#d98a1f"),
    "cheer": bgr("#43a35f"),
    "take": bgr("#43a35f"),
    "carry": bgr("#43a35f"),
    "give": bgr("#43a35f"),
    "shrug": bgr("#7d7fa8"),
    "wait": bgr("#7d7fa8"),
    "search": bgr("#7d7fa8"),
    "talk": bgr("#3a7bd5"),
}
"""Colours of the character's actions."""


def mood_color(mood: float) -> Color:
    """Return the colour of a mood from angry, −1, over neutral to happy, 1."""
    return between(NEUTRAL, HAPPY if mood > 0 else ANGRY, min(1.0, abs(mood)))
