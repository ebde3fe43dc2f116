"""Loading a character to be played, with motions lent to one that has none of its own."""

from pathlib import Path

from cubeling.characters.model.character import Character
from cubeling.characters.skeleton.detached import leaders_of_detached


def load_to_play(
    name_or_path: "str | Path", *, own_motions_only: bool = False, whole_limbs: bool = True
) -> Character:
    """Load a character as `Character.load` does, and lend it motions if it has none.

    Parameters
    ----------
    name_or_path
        The name of a bundled character, or the path of a file.
    own_motions_only
        Whether one without motions is left as it is.
    whole_limbs
        Whether a foot that the file has elsewhere than below its shin moves with that.

    Raises
    ------
    CharacterError
        As `Character.load`.
    """
    character = Character.load(name_or_path)
    if character.lender is None:
        return _with_whole_limbs(character) if whole_limbs else character
    if own_motions_only:
        return character
    # Few characters borrow: what retargets is loaded for those.
    from cubeling.characters.retargeting.lent_motions import with_lent_motions

    return with_lent_motions(character)


def _with_whole_limbs(character: Character) -> Character:
    if not leaders_of_detached(character.skeleton, character.anatomy):
        return character
    from cubeling.characters.retargeting.attached_limbs import with_whole_limbs

    return with_whole_limbs(character)
