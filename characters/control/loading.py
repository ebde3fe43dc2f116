"""Loading a character to be played, with motions lent to one that has none of its own."""

from pathlib import Path

from cubeling.characters.model.character import Character


def load_to_play(name_or_path: "str | Path", *, own_motions_only: bool = False) -> Character:
    """Load a character as `Character.load` does, and lend it motions if it has none.

    Parameters
    ----------
    name_or_path
        The name of a bundled character, or the path of a file.
    own_motions_only
        Whether one without motions is left as it is.

    Raises
    ------
    CharacterError
        As `Character.load`.
    """
    character = Character.load(name_or_path)
    if own_motions_only or character.lender is None:
        return character
    # Few characters borrow: what retargets is loaded for those.
    from cubeling.characters.retargeting.lent_motions import with_lent_motions

    return with_lent_motions(character)
