"""The .gestures files of the bundled characters: how each beats the rhythm of its speech."""

from collections.abc import Callable

from cubeling.characters.model.character import Character
from cubeling.characters.synthesis.gestures.library import GestureLibrary
from tools.authoring.gestures.human import human_gestures
from tools.authoring.vleo.speech_gestures import vleo_gestures

GESTURES: dict[str, Callable[[Character], GestureLibrary]] = {
    "human": human_gestures,
    "vleo": vleo_gestures,
}
"""What makes the gestures of a character, by its name."""
