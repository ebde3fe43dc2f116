"""The clips of a motion graph, read from any files and brought to one skeleton."""

from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path

from cubeling.app.errors import AppError
from cubeling.characters import Character, Clip
from cubeling.characters.model import Recording, load_recording, retarget
from cubeling.characters.motion import DEFAULT_RATE_HZ


def clip_names(given: Sequence[str]) -> list[str]:
    """Return the clips that names stand for: a character without "#CLIP" stands for all of its.

    Raises
    ------
    CharacterError
        If a character cannot be read.
    """
    names: list[str] = []
    for name in given:
        if "#" in name or Path(name).suffix.lower() in (".bvh", ".amc"):
            names.append(name)
        else:
            names += [f"{name}#{clip}" for clip in Character.load(name).clips]
    return names


def gather(
    names: Sequence[str],
    character: Character,
    skeleton: Path | None = None,
    progress: Callable[[str], None] = lambda name: None,
) -> list[Clip]:
    """Return clips of files on the skeleton of a character, their feet held where they stand.

    Parameters
    ----------
    names
        Motions: .bvh, .amc, or FILE.glb#CLIP.
    character
        Whose skeleton they get; it has a root joint on the ground.
    skeleton
        The .asf of .amc files, if it is in another folder.
    progress
        Called with each name before it is read.

    Raises
    ------
    CharacterError
        If a file cannot be read, or its body differs too much from the character's.
    AppError
        If two clips have one name.
    """
    clips: dict[str, Clip] = {}
    for name in names:
        progress(name)
        recording = load_recording(name, skeleton)
        if recording.clip.name in clips:
            raise AppError(f"two clips are named {recording.clip.name!r}; give each of them once")
        clips[recording.clip.name] = fit_recording(recording, character)
    return list(clips.values())


def fit_recording(recording: Recording, character: Character) -> Clip:
    """Return a recording on the skeleton of a character; its own clips stay as they are."""
    clip = recording.clip
    if recording.skeleton.names == character.skeleton.names and clip.root_motion:
        return clip
    stride = max(round(clip.rate / DEFAULT_RATE_HZ), 1)
    if stride > 1 and not clip.loop:  # frames that the graph would leave out anyway
        clip = replace(clip, rate=clip.rate / stride, poses=clip.poses[::stride])
    return retarget(
        clip,
        recording.skeleton,
        recording.anatomy,
        character.skeleton,
        character.anatomy,
        meshes=character.meshes,
    )
