"""The people of a folder of standing recordings, on the human's skeleton."""

from collections.abc import Sequence
from pathlib import Path

from cubeling.app.errors import AppError
from cubeling.app.workshop.reproduction.result import Progress
from cubeling.characters import Character, CharacterError, read_motions
from cubeling.characters.motion import PostureVectors, StandingRecording, read_standing


def read_people(
    folder: Path, progress: Progress, most: int | None = None
) -> tuple[Sequence[StandingRecording], PostureVectors]:
    """Return a recording of each person in a folder of .bvh files, and what their vectors hold.

    Raises
    ------
    AppError
        If there are fewer than two, or one cannot be read.
    """
    human = Character.load("human")
    files = sorted(folder.glob("*.bvh"))[:most]
    if len(files) < 2:
        raise AppError(f"there are not two .bvh files in '{folder}'")
    people = []
    for file in files:
        progress(f"reading {file.name}")
        try:
            (clip,) = read_motions([str(file)], human)
            people.append(read_standing(clip, human.skeleton, human.anatomy))
        except CharacterError as error:
            raise AppError(str(error)) from error
    return people, PostureVectors.of(human.skeleton, human.anatomy)
