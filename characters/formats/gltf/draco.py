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
_MESH, _SEQUENTIAL, _HAS_METADATA = 1, 0, 0x8000  # of Draco's header
_MAX_DEPTH = 8
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
            data = bytes(file.view(packed["bufferView"]))
            _check_counts(file, primitive, *_packed_counts(data))
            mesh = _decode(data)
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


def _check_counts(file: GltfFile, primitive: Json, faces: int, vertices: int) -> None:
    """Refuse a mesh that unpacks to more than its accessors say: a few bytes can be gigabytes."""
    accessors = file.document["accessors"]
    rows = max((accessors[each]["count"] for each in primitive["attributes"].values()), default=0)
    corners = accessors[primitive["indices"]]["count"] if "indices" in primitive else 3 * faces
    if 3 * faces != corners or vertices > rows:
        raise DamagedFileError(
            f"its compressed part has {faces} triangles of {vertices} vertices, its accessors "
            f"have {corners // 3} of {rows}"
        )
    for count in (corners, rows):
        if count > file.budget.numbers:
            raise DamagedFileError("its compressed part is larger than that of any character")


def _packed_counts(data: bytes) -> tuple[int, int]:
    """Return how many triangles and vertices a compressed mesh says that it has.

    Source: Draco Bitstream Specification 2.2 (Galligan 2017), headers of the file and of the
    connectivity. glTF allows no other version.
    """
    if data[:7] != b"DRACO\x02\x02" or len(data) < 11:
        raise DamagedFileError("is not compressed by Draco 2.2; compress it again")
    method, flags = data[8], int.from_bytes(data[9:11], "little")
    if data[7] != _MESH:
        raise DamagedFileError("is compressed as a cloud of points")
    reader = _Reader(data, 11)
    if flags & _HAS_METADATA:
        for _ in range(reader.number()):
            reader.number()  # of the attribute that it tells of
            reader.skip_metadata()
        reader.skip_metadata()
    if method == _SEQUENTIAL:
        return reader.number(), reader.number()
    reader.skip(1)  # how the triangles are visited
    vertices = reader.number()
    return reader.number(), vertices


class _Reader:
    """Reads the header of a compressed mesh."""

    def __init__(self, data: bytes, place: int) -> None:
        self._data, self._place = data, place

    def number(self) -> int:
        """Return a whole number: seven bits of it in each byte, the lowest first."""
        value = shift = 0
        while shift <= 28:
            byte = self.byte()
            value |= (byte & 0x7F) << shift
            if byte < 0x80:
                return value
            shift += 7
        raise DamagedFileError("its compressed part is damaged")

    def byte(self) -> int:
        """Return the next byte."""
        if self._place >= len(self._data):
            raise DamagedFileError("its compressed part is cut off")
        self._place += 1
        return self._data[self._place - 1]

    def skip(self, count: int) -> None:
        """Leave out some bytes."""
        self._place += count

    def skip_metadata(self, depth: int = 0) -> None:
        """Leave out names with their values, and the same within them."""
        if depth > _MAX_DEPTH:
            raise DamagedFileError("its compressed part is damaged")
        for _ in range(self.number()):
            self.skip(self.byte())
            self.skip(self.number())
        for _ in range(self.number()):
            self.skip(self.byte())
            self.skip_metadata(depth + 1)


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
