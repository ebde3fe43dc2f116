"""Single motions from files."""

from pathlib import Path

from characters.clip import Clip
from characters.errors import CharacterError
from characters.formats import gltf


def load_clip(path: "str | Path", name: str | None = None) -> Clip:
    """Read one motion from a .glb or .gltf file.

    Parameters
    ----------
    path
        The file.
    name
        Which of its clips; may be left out where there is only one.

    Raises
    ------
    CharacterError
        If the file cannot be read, or does not have exactly that clip.
    """
    path = Path(path)
    if path.suffix.lower() not in (".glb", ".gltf"):
        raise CharacterError(f"{path}: motions are read from .glb and .gltf files; convert it")
    clips = gltf.load(path).clips
    if name is None and len(clips) == 1:
        return next(iter(clips.values()))
    if name in clips:
        return clips[name]
    there = ", ".join(clips) or "no clips at all"
    raise CharacterError(f"{path}: has {there}; say which one to load")
