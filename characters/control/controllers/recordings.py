"""Motions for a character's controller: read from files and retargeted, or its own."""

from collections.abc import Iterator, Sequence
from pathlib import Path

from cubeling.characters.errors import CharacterError
from cubeling.characters.formats.loading import MOTION_READERS
from cubeling.characters.model.bind_pose import with_bind_pose
from cubeling.characters.model.character import CHARACTER_READERS, Character
from cubeling.characters.motion.clip import Clip
from cubeling.characters.retargeting import load_recording, retarget


def read_motions(names: Sequence[str], character: Character) -> list[Clip]:
    """Read motions and retarget them to a character.

    Parameters
    ----------
    names
        Motion files, characters with one of their clips ("fox.glb#Walk"), and folders, of which
        every motion is read, in the order of their names.
    character
        Whom they are for.

    Raises
    ------
    CharacterError
        If one cannot be read, or does not suit the character's body.
    """
    skeleton = with_bind_pose(character)
    clips = []
    for name in _files(names):
        recording = load_recording(name)
        try:
            clip = retarget(
                recording.clip,
                recording.skeleton,
                recording.anatomy,
                skeleton,
                character.anatomy,
                meshes=character.meshes,
            )
        except CharacterError as error:
            raise CharacterError(f"{recording.origin}: {error}") from None
        clips.append(clip)
    return clips


def _files(names: Sequence[str]) -> Iterator[str]:
    """Yield names, and the motion files of folders."""
    suffixes = {*MOTION_READERS} - {*CHARACTER_READERS, ".asf"}  # an .asf holds a skeleton only
    for name in names:
        folder = Path(name)
        if not folder.is_dir():
            yield name
            continue
        found = sorted(path for path in folder.rglob("*") if path.suffix.lower() in suffixes)
        if not found:
            raise CharacterError(
                f"{name}: no motion in this folder; there should be {', '.join(sorted(suffixes))}"
            )
        yield from map(str, found)
