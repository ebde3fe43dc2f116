"""What a character does when the cube is shaken."""

from cubeling.app.pipeline.table.situation import Situation
from cubeling.tracking import CubeControls

SHAKE_ACTIONS = ("jump", "wave", "cheer")
"""What the character does when the cube is shaken, in turn, if it knows the action."""


class ShakeReaction:
    """Answers each shake with one action, until that is over.

    Beyond the thesis. `first` is the number of the action that answers the first shake.
    """

    def __init__(self, first: int = 0) -> None:
        self._shakes = first
        self._action: tuple[str, bool] | None = None  # its name, and whether it has begun

    def update(self, controls: CubeControls, situation: Situation) -> str:
        """Return the action that answers a shake until it is over, or ""."""
        known = [action for action in SHAKE_ACTIONS if action in situation.actions]
        if controls.shaken and known and self._action is None:
            self._action = known[self._shakes % len(known)], False
            self._shakes += 1
        if self._action is None:
            return ""
        name, begun = self._action
        character = situation.character
        performing = character is not None and character.state == name
        self._action = None if begun and not performing else (name, begun or performing)
        return name if self._action else ""
