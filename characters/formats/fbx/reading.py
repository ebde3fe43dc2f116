"""Characters and motions of FBX files (extra `[fbx]`), converted to glTF by a process of its own.

ufbx bakes pivots, pre-rotations and curves of any order of axes, as Mixamo and others use them, to
what glTF has.
"""

import subprocess
import sys
from importlib.util import find_spec
from pathlib import Path

from cubeling.characters.errors import CharacterError
from cubeling.characters.formats.gltf import reading as gltf
from cubeling.characters.formats.loading import MotionOptions, RecordedMotion
from cubeling.characters.model.character import Character
from cubeling.files import FileKind

FBX_FILE = FileKind(
    "FBX",
    (".fbx",),
    CharacterError,
    1 << 29,
    "cubeling.characters.formats.fbx.reading:load_character",
)
"""A .fbx file with a character, a motion or both."""

MAX_SECONDS = 60.0
"""Longer conversions are given up: Mixamo's take a second, most of it to start."""

_CONVERTER = "cubeling.characters.formats.fbx.conversion"
_OPENED_IN_BLENDER = "open it in Blender and export it as .glb"


def load_character(path: Path) -> Character:
    """Read a character with its clips."""
    return gltf.load_character(path, _as_gltf(path))


def load_motion(path: Path, options: MotionOptions) -> RecordedMotion:
    """Read one clip of a file and its skeleton."""
    return gltf.load_motion(path, options, _as_gltf(path))


def has_mesh(path: Path) -> bool:
    """Return whether a file has a mesh; one that cannot be read is said to have one."""
    try:
        return b"PolygonVertexIndex" in FBX_FILE.read(path)  # which every mesh has
    except CharacterError:
        return True


def _as_gltf(path: Path) -> bytes:
    """Return the .glb of an .fbx file."""
    data = FBX_FILE.read(path)
    if find_spec("ufbx") is None:
        raise CharacterError(
            f"{path}: .fbx files need ufbx: pip install ufbx (the extra [fbx]); or convert it: "
            f"{blender_command(path)}"
        )
    try:
        done = subprocess.run(
            [sys.executable, "-m", _CONVERTER, str(path.parent)],
            input=data,
            capture_output=True,
            timeout=MAX_SECONDS,
            check=False,
        )
    except subprocess.TimeoutExpired:
        reason = f"not converted within {MAX_SECONDS:.0f} s"
        raise CharacterError(f"{path}: {reason}; {_OPENED_IN_BLENDER}") from None
    if done.returncode == 0:
        return done.stdout
    told = " ".join(done.stderr.decode(errors="replace").split())
    reason = told[-200:] if done.returncode == 2 else "its content makes the reader fail"
    raise CharacterError(
        f"{path}: not an FBX file that can be read ({reason}); {_OPENED_IN_BLENDER}"
    )


def blender_command(path: Path) -> str:
    """Return the command by which Blender converts an .fbx to a .glb beside it."""
    steps = (
        "import bpy",
        "bpy.ops.wm.read_factory_settings(use_empty=True)",
        f"bpy.ops.import_scene.fbx(filepath={str(path)!r})",
        f"bpy.ops.export_scene.gltf(filepath={str(path.with_suffix('.glb'))!r})",
    )
    return f'blender --background --python-expr "{"; ".join(steps)}"'
