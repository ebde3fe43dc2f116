"""Files that characters and motions are read from and written to."""

from characters.formats.gltf import reading as gltf
from characters.formats.loading import load_clip, load_motion
from characters.model.character import READERS, WRITERS
from characters.model.performance import Performance

READERS |= {".glb": gltf.load, ".gltf": gltf.load, ".vrm": gltf.load}
WRITERS[".glb"] = gltf.save

__all__ = ["Performance", "load_clip", "load_motion"]
