"""File formats of characters and motions.

A format is one module (or folder) with its reader, and one line here. A reader is imported when
its first file is read.
"""

from collections.abc import Callable
from importlib import import_module
from typing import Any

from cubeling.characters.formats.loading import (
    MESH_FINDERS,
    MOTION_READERS,
    Performance,
    is_motion_only,
    load_motion,
)
from cubeling.characters.model.character import CHARACTER_READERS, CHARACTER_WRITERS


def _deferred(module: str, function: str) -> Callable[..., Any]:
    """Return a function of a module of this folder that imports the module when it is called."""
    return lambda *arguments: getattr(import_module(f"{__name__}.{module}"), function)(*arguments)


CHARACTER_READERS |= dict.fromkeys(
    (".glb", ".gltf", ".vrm"), _deferred("gltf.reading", "load_character")
)
CHARACTER_WRITERS[".glb"] = _deferred("gltf.writing", "save")
MOTION_READERS |= dict.fromkeys(CHARACTER_READERS, _deferred("gltf.reading", "load_motion"))
MESH_FINDERS |= dict.fromkeys((".glb", ".gltf"), _deferred("gltf.file", "has_mesh"))
MOTION_READERS |= {
    ".vrma": _deferred("gltf.reading", "load_motion"),
    ".bvh": _deferred("mocap.bvh", "load_motion"),
    ".amc": _deferred("mocap.amc", "load_motion"),
    ".asf": _deferred("mocap.asf", "refuse_motion"),
    ".bap": _deferred("mocap.bap", "load_motion"),
}

__all__ = ["Performance", "is_motion_only", "load_motion"]
