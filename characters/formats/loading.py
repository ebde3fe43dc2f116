"""Single motions from files of any format."""

from pathlib import Path

from characters.errors import CharacterError
from characters.formats.gltf import reading as gltf
from characters.formats.mocap import amc, bvh
from characters.model.performance import Performance
from characters.motion.clip import Clip

_GLTF = (".glb", ".gltf", ".vrm")


def load_clip(path: "str | Path", name: str | None = None) -> Clip:
    """Read one motion from a .bvh, .amc (with its .asf beside it), .glb, .gltf or .vrm file.

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
    return load_motion(path, name).clip


def load_motion(
    path: "str | Path",
    name: str | None = None,
    *,
    skeleton: "str | Path | None" = None,
    rate: float | None = None,
    scale: float | None = None,
    up: str | None = None,
) -> Performance:
    """Read one motion and the skeleton that it is of; formats as for `load_clip`.

    Motion capture comes in metres with +y up, whatever the file is in, with rest rotations that
    are the identity. Its clips do not loop, and have no root motion: the hips go where they went.

    Parameters
    ----------
    path
        The file.
    name
        Which of its clips; may be left out where there is only one.
    skeleton
        The .asf file of an .amc; left out, the one beside it.
    rate
        Frames a second of an .amc [Hz]; left out, what it says, or 120.
    scale, up
        Metres a unit and the axis ("y", "z", "-y", …) that points up in a .bvh or .amc file;
        left out, they are recognised, and `Performance.notes` says how.

    Raises
    ------
    CharacterError
        If the file cannot be read, or does not have exactly that clip.
    """
    path = Path(path)
    kind = path.suffix.lower()
    if kind == ".bvh":
        performance = bvh.load(path, scale=scale, up=up)
    elif kind == ".amc":
        performance = amc.load(path, skeleton, rate=rate, scale=scale, up=up)
    elif kind in _GLTF:
        return _from_gltf(path, name)
    elif kind == ".asf":
        raise CharacterError(f"{path}: a skeleton does not move; give the .amc that goes with it")
    else:
        raise CharacterError(
            f"{path}: motions are read from .bvh, .amc, .glb, .gltf and .vrm files; convert it"
        )
    if name not in (None, performance.clip.name):
        raise CharacterError(
            f"{path}: has no clip {name!r}, only {performance.clip.name!r}; leave the name out"
        )
    return performance


def _from_gltf(path: Path, name: str | None) -> Performance:
    skeleton, clips = gltf.load_clips(path)
    if name is None and len(clips) == 1:
        return Performance(skeleton, next(iter(clips.values())))
    if name in clips:
        return Performance(skeleton, clips[name])
    there = ", ".join(clips) or "no clips at all"
    raise CharacterError(f"{path}: has {there}; say which one to load")
