"""The least that writes a glTF by hand, so that the reader is not tested by our writer."""

import json
import struct
from pathlib import Path
from typing import Any

import numpy as np

SAMPLES = sorted((Path(__file__).parents[4] / "shared" / "data" / "gltf").glob("*.glb"))
"""Characters of other makers, where they lie beside the checkout."""


def glb(document, blob=b""):
    """A .glb of this JSON, given as text or as what to make it of, and these bytes."""
    text = document.encode() if isinstance(document, str) else json.dumps(document).encode()
    text += b" " * (-len(text) % 4)
    chunks = struct.pack("<I4s", len(text), b"JSON") + text
    chunks += struct.pack("<I4s", len(blob), b"BIN\0") + blob
    return struct.pack("<4sII", b"glTF", 2, 12 + len(chunks)) + chunks


class Builder:
    """Collects accessors into one buffer while a test fills in the document."""

    def __init__(self) -> None:
        self.blob = b""
        self.document: dict[str, Any] = {
            "asset": {"version": "2.0"},
            "accessors": [],
            "bufferViews": [],
            "nodes": [],
            "meshes": [],
            "skins": [],
            "animations": [],
        }

    def view(self, data: bytes) -> int:
        start = len(self.blob)
        self.document["bufferViews"].append(
            {"buffer": 0, "byteOffset": start, "byteLength": len(data)}
        )
        self.blob += data + bytes(-len(data) % 4)
        return len(self.document["bufferViews"]) - 1

    def add(self, array, kind, component, **extra):
        accessor = {
            "bufferView": self.view(array.tobytes()),
            "componentType": component,
            "count": len(array),
            "type": kind,
        }
        self.document["accessors"].append(accessor | extra)
        return len(self.document["accessors"]) - 1

    def floats(self, values, kind):
        return self.add(np.asarray(values, np.float32), kind, 5126)

    def animate(self, interpolation, times, values, path="rotation", node=2):
        kind = {"rotation": "VEC4", "weights": "SCALAR"}.get(path, "VEC3")
        sampler = {
            "input": self.floats(times, "SCALAR"),
            "output": self.floats(values, kind),
            "interpolation": interpolation,
        }
        channel = {"sampler": 0, "target": {"node": node, "path": path}}
        self.document["animations"] = [{"name": "a", "samplers": [sampler], "channels": [channel]}]

    def bytes(self):
        self.document["buffers"] = [{"byteLength": len(self.blob)}]
        return glb(self.document, self.blob)


def build_arm() -> Builder:
    """Two joints under an ancestor that turns z up into y up and millimetres into metres."""
    build = Builder()
    build.document["nodes"] = [
        {"children": [1], "rotation": [-(0.5**0.5), 0, 0, 0.5**0.5], "scale": [1e-3] * 3},
        {"name": "upper", "children": [2]},
        {"name": "lower", "translation": [0, 0, 300]},
        {"name": "sleeve", "mesh": 0, "skin": 0, "translation": [9, 9, 9]},
    ]
    inverse_bind = np.tile(np.eye(4), (2, 1, 1))
    inverse_bind[1, :3, 3] = [0, 0, -300]
    columns = np.swapaxes(inverse_bind, 1, 2).reshape(2, 16)
    attributes = {
        "POSITION": build.floats([[0, 0, 0], [10, 0, 0], [0, 0, 600]], "VEC3"),
        "JOINTS_0": build.add(
            np.array([[0, 0, 0, 0], [0, 0, 0, 0], [1, 0, 0, 0]], np.uint8), "VEC4", 5121
        ),
        "WEIGHTS_0": build.add(
            np.array([[255, 0, 0, 0], [255, 0, 0, 0], [254, 0, 0, 0]], np.uint8),
            "VEC4",
            5121,
            normalized=True,
        ),
    }
    build.document["meshes"] = [{"primitives": [{"attributes": attributes}]}]
    bind = build.floats(columns, "MAT4")
    build.document["skins"] = [{"joints": [1, 2], "inverseBindMatrices": bind}]
    return build
