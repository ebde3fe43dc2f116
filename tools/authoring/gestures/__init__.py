"""The gesture libraries of the bundled characters."""

from collections.abc import Callable

from characters.model.character import Character
from characters.synthesis.gestures.library import GestureLibrary
from tools.authoring.gestures.human import human_gestures

GESTURES: dict[str, Callable[[Character], GestureLibrary]] = {"human": human_gestures}
"""What makes the gestures of a character, by its name."""
