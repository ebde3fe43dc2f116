"""How a character beats the rhythm of what it says: the .gestures file beside it."""

from pathlib import Path
from typing import TYPE_CHECKING

from cubeling.characters.errors import CharacterError
from cubeling.characters.skeleton.pose import Skeleton
from cubeling.files import is_there

if TYPE_CHECKING:
    from cubeling.characters.synthesis.gestures.library import GestureLibrary


def gestures_beside(path: Path, skeleton: Skeleton) -> "GestureLibrary | None":
    """Return the gestures in the .gestures file beside the file of a character; None without one.

    Raises
    ------
    CharacterError
        If it cannot be read, or was made for another skeleton.
    """
    file = path.with_suffix(".gestures")
    return gestures_for(file, skeleton, path.name) if is_there(file) else None


def gestures_for(file: Path, skeleton: Skeleton, name: str) -> "GestureLibrary":
    """Return the gestures of a file for the character of this name.

    Raises
    ------
    CharacterError
        If it cannot be read, or was made for another skeleton.
    """
    from cubeling.characters.synthesis.archive import skeleton_identity
    from cubeling.characters.synthesis.gestures.library import GestureLibrary

    library = GestureLibrary.load(file)
    if library.skeleton_identity != skeleton_identity(skeleton):
        raise CharacterError(
            f"{file}: made for another skeleton than that of {name}; make it again with "
            f"cubeling gesture learn --character {name}"
        )
    return library
