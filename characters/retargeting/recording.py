"""Motions from files, with what they are of."""

from dataclasses import dataclass, replace
from pathlib import Path

from characters.errors import CharacterError
from characters.formats.loading import is_motion_only, load_motion
from characters.model.bind_pose import with_bind_pose
from characters.model.character import Character
from characters.model.sidecar import read_sidecar
from characters.motion.clip import Clip
from characters.skeleton.anatomy import Anatomy
from characters.skeleton.pose import Skeleton


@dataclass(frozen=True)
class Recording:
    """A motion, and what it is of."""

    origin: str
    """What to call it."""

    clip: Clip
    """The motion."""

    skeleton: Skeleton
    """What it moves, resting as it was modelled."""

    anatomy: Anatomy
    """Which joint is which part."""


def load_recording(name: str, skeleton: "str | Path | None" = None) -> Recording:
    """Read a motion: a .bvh or .amc file, or a clip of a character.

    What its joints are may be said in a [joints] table of a .toml file beside it.

    Parameters
    ----------
    name
        A file, or a file or bundled character and one of its clips: "fox.glb#Walk".
    skeleton
        The .asf file of an .amc, where it does not lie beside it.

    Raises
    ------
    CharacterError
        If there is no such motion.
    """
    file, _, clip = name.partition("#")
    if is_motion_only(file):
        motion = load_motion(file, clip or None, skeleton=skeleton)
        beside = Path(file).with_suffix(".toml")
        joints = read_sidecar(beside, (motion.clip.name,)).semantics
        try:
            anatomy = Anatomy.guess(motion.skeleton, joints)
        except CharacterError as error:
            raise CharacterError(f"{beside}: {error}") from None
        return Recording(Path(name).name, motion.clip, motion.skeleton, anatomy)
    character = Character.load(file)
    if not clip and len(character.clips) == 1:
        clip = next(iter(character.clips))
    if clip not in character.clips:
        there = ", ".join(character.clips) or "none"
        raise CharacterError(
            f"{file}: which clip? write {file}#CLIP with one of its clips: {there}"
        )
    found = character.clips[clip]
    modelled = replace(character, skeleton=with_bind_pose(character))
    return Recording(Path(name).name, found, modelled.skeleton, modelled.anatomy)
