"""Reading one motion from a file of any registered format."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path

from cubeling.characters.errors import CharacterError
from cubeling.characters.model.character import CHARACTER_READERS, conversion_advice, format_suffix
from cubeling.characters.motion.clip import Clip
from cubeling.characters.skeleton.pose import Skeleton
from cubeling.registry import Registry


@dataclass(frozen=True)
class RecordedMotion:
    """A recorded motion with the skeleton that its poses belong to."""

    skeleton: Skeleton
    """The performer's joints and rest pose [m], in glTF's axes (+y up)."""

    clip: Clip
    """The motion, on that skeleton."""

    notes: tuple[str, ...] = ()
    """Guesses and repairs while reading, one line each, for a person to check."""

    semantics: Mapping[str, str] = field(default_factory=dict)
    """Joint by body part, as far as the file states it."""


@dataclass(frozen=True)
class MotionOptions:
    """What the caller states about a motion file; None leaves it to the reader."""

    clip: str | None = None
    """Name of the clip."""

    skeleton: Path | None = None
    """The file with the skeleton, for formats that keep it apart."""

    rate: float | None = None
    """Frame rate [Hz], for formats that may not state it, or state it wrongly."""

    scale: float | None = None
    """Unit of length [m], for formats that do not state it."""

    up: str | None = None
    """The vertical axis ("y", "z", "-y", …), for formats that do not state it."""


_FORMATS = "cubeling.characters.formats"

MOTION_READERS = Registry[Callable[[Path, MotionOptions], RecordedMotion]](
    {
        ".glb": f"{_FORMATS}.gltf.reading:load_motion",
        ".gltf": f"{_FORMATS}.gltf.reading:load_motion",
        ".vrm": f"{_FORMATS}.gltf.reading:load_motion",
        ".vrma": f"{_FORMATS}.gltf.reading:load_motion",
        ".fbx": f"{_FORMATS}.fbx.reading:load_motion",
        ".bvh": f"{_FORMATS}.mocap.bvh:load_motion",
        ".amc": f"{_FORMATS}.mocap.amc:load_motion",
        ".asf": f"{_FORMATS}.mocap.asf:refuse_motion",
        ".bap": f"{_FORMATS}.mocap.bap:load_motion",
    }
)
"""Readers of one motion, by the suffix of the file; a new format is registered here."""

MESH_FINDERS = Registry[Callable[[Path], bool]](
    {
        ".glb": f"{_FORMATS}.gltf.file:has_mesh",
        ".gltf": f"{_FORMATS}.gltf.file:has_mesh",
        ".fbx": f"{_FORMATS}.fbx.reading:has_mesh",
    }
)
"""What finds out whether a file has a mesh, by the suffix of files that need not have one."""


def load_motion(
    path: "str | Path",
    name: str | None = None,
    *,
    skeleton: "str | Path | None" = None,
    rate: float | None = None,
    scale: float | None = None,
    up: str | None = None,
) -> RecordedMotion:
    """Read one motion from a .bvh, .amc (with its .asf), .glb, .gltf, .vrm, .vrma or .fbx file.

    Motion capture is returned in metres with +y up, with identity rest rotations. Its clips do
    not loop and have no root motion: the hips carry the motion over the ground.

    Parameters
    ----------
    path
        The file.
    name
        The clip; may be left out if there is only one.
    skeleton
        The .asf file of an .amc; left out, the one in the same folder.
    rate
        Frame rate of a .bvh or .amc file [Hz]; left out, what it states, or 120 for an .amc.
    scale, up
        Unit [m] and vertical axis ("y", "z", "-y", …) of a .bvh or .amc file; left out, they
        are recognised, and `RecordedMotion.notes` says how.

    Raises
    ------
    CharacterError
        If the file cannot be read, or does not have exactly that clip.
    """
    path = Path(path)
    reader = MOTION_READERS.get(format_suffix(path))
    if reader is None:
        known = ", ".join(sorted(MOTION_READERS))
        advice = conversion_advice(path)
        raise CharacterError(f"{path}: not a motion file of {known}; {advice}")
    stated = MotionOptions(name, None if skeleton is None else Path(skeleton), rate, scale, up)
    recorded = reader(path, stated)
    if name not in (None, recorded.clip.name):
        raise CharacterError(
            f"{path}: has no clip {name!r}, only {recorded.clip.name!r}; leave the name out"
        )
    return recorded


def is_motion_only(path: "str | Path") -> bool:
    """Return whether a file holds motions and no character: by its suffix, or without a mesh."""
    path = Path(path)
    suffix = format_suffix(path)
    if suffix not in CHARACTER_READERS:
        return suffix in MOTION_READERS
    has_mesh = MESH_FINDERS.get(suffix)
    return has_mesh is not None and path.is_file() and not has_mesh(path)
