"""The one buffer of a .glb that is being written, and the accessors into it."""

import json
import struct

import numpy as np
import pygltflib
from numpy.typing import ArrayLike, NDArray

from characters.formats.gltf.file import COMPONENTS, WIDTHS

ARRAY_BUFFER, ELEMENT_BUFFER = 34962, 34963
"""What a buffer view is for: vertices, or their numbers."""

_TYPES = {1: "SCALAR", 2: "VEC2", 3: "VEC3", 4: "VEC4", 16: "MAT4"}
_COMPONENT_OF = {np.dtype(dtype): code for code, dtype in COMPONENTS.items()}

assert all(WIDTHS[name] == width for width, name in _TYPES.items())


class BufferWriter:
    """Collects arrays into one buffer while a document grows.

    Parameters
    ----------
    document
        Where accessors and buffer views are listed.
    """

    def __init__(self, document: pygltflib.GLTF2) -> None:
        self.document = document
        self.blob = bytearray()

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
        accessor = pygltflib.Accessor(
            bufferView=self.view(rows.tobytes(), target),
            componentType=_COMPONENT_OF[np.dtype(dtype)],
            count=len(rows),
            type=_TYPES[rows.shape[1]],
            normalized=normalized,
        )
        if bounds:
            accessor.min, accessor.max = rows.min(0).tolist(), rows.max(0).tolist()
        return self._listed(accessor)

    def sparse(self, count: int, where: NDArray[np.uint32], values: NDArray[np.float32]) -> int:
        """Append an array that is zero but at the rows `where`, which ascend."""
        rows = _rows(values, np.float32)
        low = high = np.zeros(rows.shape[1], np.float32)
        accessor = pygltflib.Accessor(
            byteOffset=None,
            componentType=_COMPONENT_OF[np.dtype(np.float32)],
            count=count,
            type=_TYPES[rows.shape[1]],
        )
        if len(rows):
            wide = np.uint16 if count <= 65536 else np.uint32
            accessor.sparse = pygltflib.Sparse(
                count=len(rows),
                indices=pygltflib.AccessorSparseIndices(
                    bufferView=self.view(_rows(where, wide).tobytes()),
                    componentType=_COMPONENT_OF[np.dtype(wide)],
                ),
                values=pygltflib.AccessorSparseValues(bufferView=self.view(rows.tobytes())),
            )
            low, high = rows.min(0), rows.max(0)
            if len(rows) < count:
                low, high = np.minimum(low, 0), np.maximum(high, 0)
        accessor.min, accessor.max = low.tolist(), high.tolist()
        return self._listed(accessor)

    def view(self, data: bytes, target: int | None = None) -> int:
        """Append bytes and return the number of their buffer view."""
        view = pygltflib.BufferView(
            buffer=0, byteOffset=len(self.blob), byteLength=len(data), target=target
        )
        self.blob += data + bytes(-len(data) % 4)
        self.document.bufferViews.append(view)
        return len(self.document.bufferViews) - 1

    def container(self) -> bytes:
        """Return the .glb: the header and the two chunks."""
        self.document.buffers = [pygltflib.Buffer(byteLength=len(self.blob))]
        plain = json.loads(self.document.to_json())
        text = json.dumps(plain, separators=(",", ":"), sort_keys=True).encode()
        text += b" " * (-len(text) % 4)
        chunks = struct.pack("<I4s", len(text), b"JSON") + text
        chunks += struct.pack("<I4s", len(self.blob), b"BIN\0") + self.blob
        return struct.pack("<4sII", b"glTF", 2, 12 + len(chunks)) + chunks

    def _listed(self, accessor: pygltflib.Accessor) -> int:
        self.document.accessors.append(accessor)
        return len(self.document.accessors) - 1


def _rows(values: ArrayLike, dtype: type[np.generic]) -> NDArray[np.generic]:
    array = np.ascontiguousarray(values, np.dtype(dtype).newbyteorder("<"))
    return array.reshape(len(array), -1) if array.size else array.reshape(0, _width(array))


def _width(array: NDArray[np.generic]) -> int:
    return array.shape[1] if array.ndim > 1 else 1
