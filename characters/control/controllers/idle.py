"""Characters that stand as a person does."""

from dataclasses import replace
from pathlib import Path

from cubeling.characters.errors import CharacterError
from cubeling.characters.model.bind_pose import with_bind_pose
from cubeling.characters.model.character import Character
from cubeling.characters.model.standing import standing_factory
from cubeling.characters.retargeting import retarget
from cubeling.characters.synthesis.archive import skeleton_identity
from cubeling.characters.synthesis.idle.recordings import read_standing
from cubeling.characters.synthesis.idle.storage import as_clips, load_person


def standing_as(character: Character, path: Path) -> Character:
    """Return a character that stands as the person of an .idle file does.

    Raises
    ------
    CharacterError
        If the file cannot be read, or its person and the character have different bodies.
    """
    person = load_person(path)
    skeleton, anatomy, recordings = person
    if skeleton_identity(skeleton) != skeleton_identity(character.skeleton):
        body, parts = with_bind_pose(character), character.anatomy
        try:
            clips = [
                retarget(each, skeleton, anatomy, body, parts, meshes=character.meshes)
                for each in as_clips(person)
            ]
            recordings = tuple(
                replace(
                    read_standing(clip, character.skeleton, parts, old.feeling), before=old.before
                )
                for clip, old in zip(clips, recordings, strict=True)
            )
        except CharacterError as error:
            raise CharacterError(f"{path}: {error}") from None
    standing = standing_factory(
        character.skeleton,
        character.anatomy,
        character.clips,
        recordings,
        acting=False,
        pauses=character.pauses,
    )
    return replace(character, standing=standing)
