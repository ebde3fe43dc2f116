"""The words for hands and rows in the editor."""

from cubeling.app.workshop.gesture_editor.editing.document import Row
from cubeling.characters.behaviour import DIRECTIONS

ROW_NAMES: dict[Row, str] = {"right": "Right hand", "left": "Left hand", "body": "Trunk and head"}
"""What each row of the time line is called."""

OPPOSITES = {
    "up": "down", "down": "up", "in": "out", "out": "in", "forward": "back", "back": "forward",
}  # fmt: skip
"""Directions that cannot be combined."""

DIRECTION_NAMES = tuple((each, each) for each in DIRECTIONS)
"""Directions of palms and fingers, each with its name on a button."""

PATH_NAMES = (
    ("line", "line"), ("arc", "arc"), ("circle", "circle"), ("wave", "wave"), ("keys", "curve"),
)  # fmt: skip
"""Paths of `HandKey`, each with its name on a button."""


def combine(present: str, chosen: str, *, added: bool) -> str:
    """Return a direction after a click on one: it alone, or added to the present.

    >>> combine("down", "in", added=True), combine("down-in", "in", added=True)
    ('down-in', 'down')
    """
    parts = [each for each in present.split("-") if each]
    if not added:
        return chosen
    if chosen in parts:
        return "-".join(each for each in parts if each != chosen) or chosen
    return "-".join([*(each for each in parts if each != OPPOSITES[chosen]), chosen][-2:])
