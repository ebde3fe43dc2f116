"""Colours of the mood plot: those of the screen, pale enough to write on."""

from cubeling.affect import LabelSet
from cubeling.app.ui.palette import ACTION_COLORS, ROBOT_COLOR, Color, between, bgr, mood_color

WHITE = bgr("#ffffff")
TEXT_COLOR, SECONDARY_COLOR, BORDER_COLOR, GRID_COLOR = "#2b3345", "#6d7385", "#a9aebb", "#dcdfe6"

CURVE_STYLES: tuple[tuple[str, tuple[float, ...]], ...] = (
    ("#000000", ()),
    ("#d55e00", (7.0, 3.0)),
    ("#0072b2", (2.0, 2.5)),
    ("#009e73", (12.0, 3.0)),
    ("#a0528f", (4.5, 2.0)),
)
"""Colours that colour-blind people can tell apart (Okabe and Ito 2008), each with its own dashes
[pt], so that the plot can be printed in grey."""


def label_color(labels: LabelSet, label: str) -> str:
    """Return the pale colour of a label: the mood's colour on screen, by its valence."""
    if labels.by_valence:
        mood = {"happy": 1.0, "angry": -1.0}.get(label, 0.0)
        arousal = 0.0
    else:
        valence, arousal = labels.places.get(label, (0.0, 0.0))
        mood = valence / 0.8
    color = mood_color(min(max(mood, -1.0), 1.0))
    # Darker with arousal, so that neighbouring regions differ in grey too.
    return _hex(between(WHITE, color, 0.36 + 0.12 * arousal + 0.06 * (mood < 0)))


def action_color(action: str, *, pale: bool = False) -> str:
    """Return the pale colour of an action, that of its icon on screen, or a paler one."""
    return _hex(between(WHITE, ACTION_COLORS.get(action, bgr("#8a8fa0")), 0.14 if pale else 0.45))


def _hex(color: Color) -> str:
    """Return (blue, green, red) as "#rrggbb"."""
    blue, green, red = color
    return f"#{red:02x}{green:02x}{blue:02x}"


OBSERVED_COLOR = _hex(ROBOT_COLOR)
"""What the robot shows: a wide pale line below the others."""
