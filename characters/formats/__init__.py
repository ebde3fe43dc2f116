"""File formats of characters and motions.

A format is one module (or folder) with its reader, and one line here.
"""

from characters.formats.gltf import reading as gltf
from characters.formats.gltf import writing
from characters.formats.loading import MOTION_READERS, Performance, load_motion
from characters.formats.mocap import amc, asf, bvh
from characters.model.character import READERS, WRITERS

READERS |= {".glb": gltf.load_character, ".gltf": gltf.load_character, ".vrm": gltf.load_character}
WRITERS[".glb"] = writing.save
MOTION_READERS |= dict.fromkeys(READERS, gltf.load_motion)
MOTION_READERS |= {".bvh": bvh.load_motion, ".amc": amc.load_motion, ".asf": asf.refuse_motion}

__all__ = ["Performance", "load_motion"]
