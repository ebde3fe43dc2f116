"""Characters that stand as a person does."""

from dataclasses import replace
from functools import partial
from pathlib import Path

from characters.errors import CharacterError
from characters.model.bind_pose import with_bind_pose
from characters.model.character import Character
from characters.retargeting import retarget
from characters.synthesis.idle.database import IdleDatabase
from characters.synthesis.idle.idle_motion import IdleMotion
from characters.synthesis.idle.posture_space import PostureVectors
from characters.synthesis.idle.recordings import read_standing
from characters.synthesis.idle.storage import as_clips, load_person


def standing_as(character: Character, path: Path) -> Character:
    """Return a character that stands as the person of an .idle file does.

    Raises
    ------
    CharacterError
        If the file cannot be read, or its person and the character have different bodies.
    """
    person = load_person(path)
    skeleton, anatomy, _ = person
    body = with_bind_pose(character)
    try:
        clips = [
            retarget(clip, skeleton, anatomy, body, character.anatomy) for clip in as_clips(person)
        ]
        recordings = [read_standing(clip, character.skeleton, character.anatomy) for clip in clips]
    except CharacterError as error:
        raise CharacterError(f"{path}: {error}") from None
    kind = PostureVectors.of(character.skeleton, character.anatomy)
    return replace(character, standing=partial(IdleMotion, IdleDatabase.of(recordings, kind)))
