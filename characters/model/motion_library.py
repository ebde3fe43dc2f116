"""The library of motions that a character walks by."""

from collections.abc import Sequence

from cubeling.characters.errors import CharacterError
from cubeling.characters.model.character import Character
from cubeling.characters.model.mirroring import mirror_of
from cubeling.characters.motion.clip import Clip
from cubeling.characters.motion.mirror import Mirror
from cubeling.characters.synthesis.cycles import with_cycles
from cubeling.characters.synthesis.library import DEFAULT_RATE_HZ, MotionLibrary


def library_of(clips: Sequence[Clip], character: Character) -> MotionLibrary:
    """Return clips on the skeleton of a character side by side, and their cycles as loops.

    Raises
    ------
    CharacterError
        If the clips make no library; see `MotionLibrary.of`.
    """
    library = MotionLibrary.of(clips, character.skeleton, character.anatomy, DEFAULT_RATE_HZ)
    return with_cycles(library, mirror_or_none(character))


def mirror_or_none(character: Character) -> Mirror | None:
    """Return the mirror of a character; None if it is not symmetric."""
    try:
        return mirror_of(character)
    except CharacterError:
        return None
