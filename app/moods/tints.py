"""Colours of the pictures of moods: the screen's own, pale enough to write on."""

from affect.labels import LabelSet
from app.ui.palette import ACTION, Color, between, bgr, mood_color

WHITE = bgr("#ffffff")
INK, QUIET, FAINT, RULE = "#2b3345", "#6d7385", "#a9aebb", "#dcdfe6"

OBSERVED = "#56b4e9"
"""What the robot shows: a wide pale line below the others."""

LINES: tuple[tuple[str, tuple[float, ...]], ...] = (
    ("#000000", ()),
    ("#d55e00", (7.0, 3.0)),
    ("#0072b2", (2.0, 2.5)),
    ("#009e73", (12.0, 3.0)),
    ("#a0528f", (4.5, 2.0)),
)
"""Colours that colour-blind people tell apart (Okabe and Ito 2008), each with its own dashes."""


def code(color: Color) -> str:
    """Return (blue, green, red) as "#rrggbb"."""
    blue, green, red = color
    return f"#{red:02x}{green:02x}{blue:02x}"


def tint(labels: LabelSet, label: str) -> str:
    """Return the pale colour of a label: the mood's colour on screen, by how pleasant it is."""
    if labels.by_valence:
        mood = {"happy": 1.0, "angry": -1.0}.get(label, 0.0)
    else:
        mood = labels.places.get(label, (0.0, 0.0))[0] / 0.8
    color = mood_color(min(max(mood, -1.0), 1.0))
    # The more stirred, the darker: in grey too a region is told from its neighbours.
    stirred = 0.0 if labels.by_valence else labels.places.get(label, (0.0, 0.0))[1]
    return code(between(WHITE, color, 0.36 + 0.12 * stirred + 0.06 * (mood < 0)))


def action_tint(action: str, *, pale: bool = False) -> str:
    """Return the pale colour of an action, that of its icon on screen, or a paler one."""
    return code(between(WHITE, ACTION.get(action, bgr("#8a8fa0")), 0.14 if pale else 0.45))
