"""Gestures by name: those of Cubeling, and those in a folder of the user's."""

import difflib
from collections.abc import Iterator, Mapping
from functools import lru_cache
from importlib import resources
from pathlib import Path

from cubeling.characters.behaviour.gestures.files import GESTURE_SUFFIX, load_gesture, save_gesture
from cubeling.characters.behaviour.symbolic_gesture import SymbolicGesture
from cubeling.characters.errors import CharacterError


class GestureCollection:
    """Gestures by their names; upper and lower case, "-" and " " make no difference.

    >>> GestureCollection.load_bundled().get("wave").name
    'WAVE'
    """

    def __init__(self, gestures: Mapping[str, SymbolicGesture], folder: Path | None = None) -> None:
        self._gestures = {_key(name): gesture for name, gesture in gestures.items()}
        self.folder = folder
        """Where `save` writes; None if nowhere."""

    @staticmethod
    def load_bundled(folder: Path | None = None) -> "GestureCollection":
        """Return Cubeling's gestures and those in a folder, which go first; it need not exist.

        Raises
        ------
        CharacterError
            If a file in the folder is no gesture.
        """
        own = {} if folder is None else gestures_in(folder)
        return GestureCollection({**_load_bundled(), **own}, folder)

    @property
    def names(self) -> tuple[str, ...]:
        """Their names, in the order of the alphabet."""
        return tuple(sorted(gesture.name for gesture in self._gestures.values()))

    def __iter__(self) -> Iterator[SymbolicGesture]:
        return iter(self._gestures[_key(name)] for name in self.names)

    def __len__(self) -> int:
        return len(self._gestures)

    def __contains__(self, name: str) -> bool:
        return _key(name) in self._gestures

    def get(self, name: str) -> SymbolicGesture:
        """Return the gesture of a name.

        Raises
        ------
        CharacterError
            If there is none.
        """
        gesture = self._gestures.get(_key(name))
        if gesture is None:
            near = difflib.get_close_matches(_key(name), self._gestures, 1)
            hint = f"did you mean {self._gestures[near[0]].name}? " if near else ""
            raise CharacterError(
                f"no gesture is called {name!r}; {hint}`cubeling gesture list` names all"
            )
        return gesture

    def save(self, gesture: SymbolicGesture) -> Path:
        """Write a gesture to the folder, and have it from now on; return its file.

        Raises
        ------
        CharacterError
            If there is no folder, or the file cannot be written.
        """
        if self.folder is None:
            raise CharacterError(f"{gesture.name}: there is no folder to save gestures in")
        path = self.folder / f"{_file_stem(gesture.name)}{GESTURE_SUFFIX}"
        save_gesture(gesture, path)
        self._gestures[_key(gesture.name)] = gesture
        return path


def gestures_in(folder: Path) -> dict[str, SymbolicGesture]:
    """Return the gestures in a folder by name; a folder that does not exist has none.

    Raises
    ------
    CharacterError
        If a file in it is no gesture.
    """
    files = sorted(folder.glob(f"*{GESTURE_SUFFIX}")) if folder.is_dir() else []
    gestures = [load_gesture(file) for file in files if not file.name.startswith(".")]
    return {gesture.name: gesture for gesture in gestures}


@lru_cache(maxsize=1)
def _load_bundled() -> dict[str, SymbolicGesture]:
    return gestures_in(Path(str(resources.files("cubeling.characters.behaviour") / "library")))


def _key(name: str) -> str:
    return name.strip().upper().replace("-", "_").replace(" ", "_")


def _file_stem(name: str) -> str:
    """Return the name of a file for a gesture's name, which may have any letters."""
    kept = "".join(letter if letter.isalnum() or letter in "-_" else "_" for letter in name.lower())
    return kept[:80]
