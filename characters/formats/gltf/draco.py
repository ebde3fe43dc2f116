"""Meshes that Draco compressed (KHR_draco_mesh_compression), unpacked to plain accessors."""

from collections.abc import Iterator
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cubeling.characters.formats.gltf.document import DamagedFileError, Json, error_context, label
from cubeling.characters.formats.gltf.file import COMPONENT_TYPES, GltfFile

EXTENSION = "KHR_draco_mesh_compression"
_TRIANGLES = 4
_CODES = {np.dtype(kind): code for code, kind in COMPONENT_TYPES.items()}


def with_unpacked_meshes(file: GltfFile) -> GltfFile:
    """Return a file whose compressed primitives have their data in buffers of their own.

    Raises
    ------
    DamagedFileError
        If a primitive cannot be unpacked.
    """
    buffers = list(file.buffers)
    for where, primitive in _compressed_primitives(file):
        with error_context(where):
            packed = primitive["extensions"][EXTENSION]
            mesh = _decode(bytes(file.view(packed["bufferView"])))
            store = partial(_store, file, buffers)
            for name, identifier in packed["attributes"].items():
                found = mesh.get_attribute_by_unique_id(identifier)
                if name not in primitive["attributes"] or found is None:
                    raise DamagedFileError(f"its compressed part has no {name!r:.20}")
                store(primitive["attributes"][name], found["data"])
            if "indices" in primitive:
                store(primitive["indices"], mesh.faces.reshape(-1, 1).astype(np.uint32))
                primitive["mode"] = _TRIANGLES
    return replace(file, buffers=tuple(buffers))


def _compressed_primitives(file: GltfFile) -> Iterator[tuple[str, Json]]:
    """Yield the primitives that are compressed, and how to call each."""
    for number, mesh in enumerate(file.all("meshes")):
        for primitive in mesh["primitives"]:
            if EXTENSION in primitive.get("extensions", {}):
                yield label("mesh", number, mesh), primitive


def _decode(data: bytes) -> Any:
    import DracoPy  # takes time to load, and few files need it

    try:
        mesh = DracoPy.decode(data)
    except Exception as error:  # it raises Exceptions of its own, and those of its parts
        raise DamagedFileError(f"Draco cannot unpack it: {error}") from None
    if not hasattr(mesh, "faces"):
        raise DamagedFileError("is compressed as a cloud of points")
    return mesh


def _store(file: GltfFile, buffers: list[bytes], number: int, values: NDArray[Any]) -> None:
    """Let an accessor read these values, (count, width), from a new buffer."""
    accessor = file.document["accessors"][number]
    if values.shape != (accessor["count"], file.width(number)) or values.dtype not in _CODES:
        raise DamagedFileError(
            f"accessor {number} says {accessor['count']} {accessor['type']}, unpacked are "
            f"{' × '.join(map(str, values.shape))} numbers"
        )
    file.budget.spend(values.size, f"accessor {number}")
    data = values.tobytes()
    views = file.document["bufferViews"]
    views.append({"buffer": len(buffers), "byteLength": len(data)})
    buffers.append(data)
    accessor |= {
        "bufferView": len(views) - 1,
        "byteOffset": 0,
        "componentType": _CODES[values.dtype],
    }
