"""The gestures on disk: the library, the user's folder, and what a crash left."""

from contextlib import suppress
from dataclasses import replace
from pathlib import Path

from cubeling.app.output_path import short_path
from cubeling.app.workshop.gesture_editor.editing.document import moves
from cubeling.characters import CharacterError
from cubeling.characters.behaviour import (
    GestureCollection,
    SymbolicGesture,
    gestures_in,
    load_gesture,
    save_gesture,
)

RECOVERY_FILE = ".unsaved.toml"
"""Where changes are kept until they are saved; the library does not list it."""

NO_NAME = "UNNAMED"
"""Name in that file of a gesture that has none yet."""


class GestureStore:
    """Opens and saves gestures.

    Parameters
    ----------
    folder
        The user's gestures; it need not exist.

    Raises
    ------
    CharacterError
        A file in the folder is no gesture.
    """

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        self._collection = GestureCollection.load_bundled(folder)
        self._own = set(gestures_in(folder))

    @property
    def names(self) -> tuple[str, ...]:
        """All gestures, in the order of the alphabet."""
        return self._collection.names

    def load(self, name: str) -> SymbolicGesture:
        """Return a gesture; raises CharacterError if there is none of that name."""
        return self._collection.get(name)

    def has(self, name: str) -> bool:
        """Return whether there is a gesture of that name."""
        return name in self._collection

    def is_own(self, name: str) -> bool:
        """Return whether a gesture is in the user's folder."""
        return name in self._own

    def save(self, gesture: SymbolicGesture) -> str:
        """Save a gesture, and return where, for a message.

        Raises
        ------
        CharacterError
            It cannot be performed, or not be written.
        """
        path = self._collection.save(gesture)
        self._own.add(gesture.name)
        self.forget()
        return short_path(path)

    def keep(self, gesture: SymbolicGesture) -> None:
        """Keep changes that are not saved yet; raises CharacterError if they cannot be written."""
        if moves(gesture):
            named = replace(gesture, name=gesture.name or NO_NAME)
            save_gesture(named, self._folder / RECOVERY_FILE)

    def recover(self) -> SymbolicGesture | None:
        """Return changes that an earlier editor could not save; None if there are none."""
        with suppress(CharacterError):
            gesture = load_gesture(self._folder / RECOVERY_FILE)
            return replace(gesture, name="") if gesture.name == NO_NAME else gesture
        return None

    def forget(self) -> None:
        """Remove what was kept: it is saved, or not wanted."""
        with suppress(OSError):
            (self._folder / RECOVERY_FILE).unlink(missing_ok=True)
