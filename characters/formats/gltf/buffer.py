"""The document and the buffer of a .glb while it is written."""

import json
import struct

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cubeling.characters.formats.gltf.document import Json
from cubeling.characters.formats.gltf.file import (
    BIN_CHUNK,
    COMPONENT_TYPES,
    JSON_CHUNK,
    MAGIC,
    TYPE_WIDTHS,
)

ARRAY_BUFFER, ELEMENT_BUFFER = 34962, 34963
"""Target of a buffer view: vertex attributes, or vertex indices."""

_TYPE_OF = {width: name for name, width in TYPE_WIDTHS.items() if name not in ("MAT2", "MAT3")}
_COMPONENT_OF = {np.dtype(dtype): code for code, dtype in COMPONENT_TYPES.items()}


class GlbBuilder:
    """Collects the members of a glTF document and appends arrays to its one buffer."""

    def __init__(self) -> None:
        self.document: Json = {"asset": {"version": "2.0", "generator": "cubeling"}, "scene": 0}
        self.blob = bytearray()

    def add(self, kind: str, item: Json) -> int:
        """Append an item to a list of the document, such as "nodes", and return its number."""
        items: list[Json] = self.document.setdefault(kind, [])
        items.append(item)
        return len(items) - 1

    def accessor(
        self,
        values: ArrayLike,
        dtype: type[np.generic],
        target: int | None = None,
        *,
        bounds: bool = False,
        normalized: bool = False,
    ) -> int:
        """Append an array, (count, components) or (count,), and return its accessor's number."""
        rows = _rows(values, dtype)
        accessor = _accessor(len(rows), rows.shape[1], dtype)
        accessor["bufferView"] = self.view(rows.tobytes(), target)
        if normalized:
            accessor["normalized"] = True
        if bounds:
            accessor |= {"min": rows.min(0).tolist(), "max": rows.max(0).tolist()}
        return self.add("accessors", accessor)

    def sparse(self, count: int, where: NDArray[np.uint32], values: NDArray[np.float32]) -> int:
        """Append an array that is zero except in the rows `where`, which ascend."""
        rows = _rows(values, np.float32)
        accessor = _accessor(count, rows.shape[1], np.float32)
        low = high = np.zeros(rows.shape[1], np.float32)
        if len(rows):
            index_type = np.uint16 if count <= 65536 else np.uint32
            accessor["sparse"] = {
                "count": len(rows),
                "indices": {
                    "bufferView": self.view(_rows(where, index_type).tobytes()),
                    "componentType": _COMPONENT_OF[np.dtype(index_type)],
                },
                "values": {"bufferView": self.view(rows.tobytes())},
            }
            low, high = rows.min(0), rows.max(0)
            if len(rows) < count:
                low, high = np.minimum(low, 0), np.maximum(high, 0)
        accessor |= {"min": low.tolist(), "max": high.tolist()}
        return self.add("accessors", accessor)

    def view(self, data: bytes, target: int | None = None) -> int:
        """Append bytes and return the number of their buffer view."""
        view = {"buffer": 0, "byteOffset": len(self.blob), "byteLength": len(data)}
        if target is not None:
            view["target"] = target
        self.blob += data + bytes(-len(data) % 4)
        return self.add("bufferViews", view)

    def glb(self) -> bytes:
        """Return the file: the header and the two chunks."""
        document = self.document | {"buffers": [{"byteLength": len(self.blob)}]}
        text = json.dumps(document, separators=(",", ":"), sort_keys=True).encode()
        text += b" " * (-len(text) % 4)
        chunks = struct.pack("<II", len(text), JSON_CHUNK) + text
        chunks += struct.pack("<II", len(self.blob), BIN_CHUNK) + self.blob
        return struct.pack("<III", MAGIC, 2, 12 + len(chunks)) + chunks


def _accessor(count: int, width: int, dtype: type[np.generic]) -> Json:
    component = _COMPONENT_OF[np.dtype(dtype)]
    return {"componentType": component, "count": count, "type": _TYPE_OF[width]}


def _rows(values: ArrayLike, dtype: type[np.generic]) -> NDArray[np.generic]:
    array = np.ascontiguousarray(values, np.dtype(dtype).newbyteorder("<"))
    width = array.shape[1] if array.ndim > 1 else 1
    return array.reshape(len(array), -1) if array.size else array.reshape(0, width)
