"""The container of glTF 2.0: its JSON, its buffers and the arrays in them."""

import base64
import json
import struct
from dataclasses import dataclass
from pathlib import Path
from typing import Any
from urllib.parse import unquote

import numpy as np
import pygltflib
from numpy.typing import NDArray

from characters.errors import CharacterError

_MOST = 10_000_000  # values out of nothing: more are a damaged count that would eat the memory
_MAGIC, _JSON, _BIN = 0x46546C67, 0x4E4F534A, 0x004E4942

COMPONENTS: dict[int, type[np.generic]] = {
    5120: np.int8,
    5121: np.uint8,
    5122: np.int16,
    5123: np.uint16,
    5125: np.uint32,
    5126: np.float32,
}
"""NumPy type of an accessor's componentType."""

WIDTHS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4, "MAT2": 4, "MAT3": 9, "MAT4": 16}
"""Number of components of an accessor's type."""

# What changes how bytes are to be read; without it nothing would come out right.
_UNDERSTOOD = {
    "KHR_mesh_quantization",
    "KHR_materials_unlit",
    "KHR_texture_transform",
    "KHR_materials_emissive_strength",
}


class DamagedFileError(ValueError):
    """Something in a glTF file that contradicts itself; the message lacks the file's name."""


@dataclass(frozen=True)
class GltfFile:
    """An opened glTF: its document and its bytes."""

    path: Path
    """Where it came from."""

    document: pygltflib.GLTF2
    """The JSON part."""

    plain: dict[str, Any]
    """The same as it stands in the file."""

    buffers: tuple[bytes, ...]
    """Content of each buffer."""

    def accessor(self, index: int, *, scaled: bool = True) -> NDArray[np.generic]:
        """Return an accessor's array, (count, components) or (count,) for scalars.

        Integers marked as normalised become floats of 0…1 or −1…1, unless not `scaled`.
        """
        if not 0 <= index < len(self.document.accessors):
            raise DamagedFileError(f"accessor {index} does not exist")
        accessor = self.document.accessors[index]
        dtype = np.dtype(COMPONENTS[accessor.componentType]).newbyteorder("<")
        width = WIDTHS[accessor.type]
        if accessor.bufferView is not None:
            offset = accessor.byteOffset or 0
            values = self._strided(accessor.bufferView, offset, dtype, accessor.count, width)
        elif accessor.count > _MOST:
            raise DamagedFileError(f"accessor {index} claims {accessor.count} values")
        else:
            values = np.zeros((accessor.count, width), dtype)
        if accessor.sparse is not None:
            values = self._with_sparse(values, accessor.sparse, dtype)
        if scaled and accessor.normalized and dtype.kind in "iu":
            limit = np.iinfo(dtype).max
            values = np.maximum(values.astype(np.float64) / limit, -1.0)
        return values[:, 0] if width == 1 else values

    def view(self, index: int) -> bytes:
        """Return the bytes of a buffer view."""
        view = self.document.bufferViews[index]
        start = view.byteOffset or 0
        data: bytes = self.buffers[view.buffer][start : start + view.byteLength]
        if start < 0 or len(data) != view.byteLength:
            raise DamagedFileError(f"buffer view {index} reaches beyond its buffer")
        return data

    def resource(self, uri: str) -> bytes:
        """Return what a URI names: data inside it, or a file beside this one."""
        if uri.startswith("data:"):
            return base64.b64decode(uri.partition(",")[2])
        beside = self.path.parent / unquote(uri)
        try:
            return beside.read_bytes()
        except OSError as error:
            raise CharacterError(
                f"{self.path}: needs {unquote(uri)}, which cannot be read "
                f"({error.strerror}); put it beside the file"
            ) from None

    def _strided(
        self, view: int, offset: int, dtype: "np.dtype[np.generic]", count: int, width: int
    ) -> NDArray[np.generic]:
        data = self.view(view)
        stride = self.document.bufferViews[view].byteStride or dtype.itemsize * width
        needed = offset + (count - 1) * stride + dtype.itemsize * width if count else 0
        if needed > len(data) or offset < 0 or stride < dtype.itemsize * width:
            raise DamagedFileError(f"buffer view {view} is too short for its accessor")
        raw = np.frombuffer(data, np.uint8)
        windows = np.lib.stride_tricks.as_strided(
            raw[offset:], (count, dtype.itemsize * width), (stride, 1), writeable=False
        )
        return np.ascontiguousarray(windows).view(dtype).reshape(count, width)

    def _with_sparse(
        self, values: NDArray[np.generic], sparse: pygltflib.Sparse, dtype: "np.dtype[np.generic]"
    ) -> NDArray[np.generic]:
        where = np.dtype(COMPONENTS[sparse.indices.componentType]).newbyteorder("<")
        rows = self._strided(
            sparse.indices.bufferView, sparse.indices.byteOffset or 0, where, sparse.count, 1
        )
        replaced = self._strided(
            sparse.values.bufferView,
            sparse.values.byteOffset or 0,
            dtype,
            sparse.count,
            values.shape[1],
        )
        values = values.copy()
        values[rows[:, 0].astype(np.intp)] = replaced
        return values


def open_gltf(path: Path) -> GltfFile:
    """Read a .glb or .gltf file with everything that it refers to.

    Raises
    ------
    CharacterError
        If it is absent, truncated, not glTF 2.0, or needs an extension that is not understood.
    """
    try:
        data = path.read_bytes()
    except OSError as error:
        raise CharacterError(f"{path}: cannot be read ({error.strerror}); check the path") from None
    text, blob = _unpack(path, data)
    try:
        plain = json.loads(text)
        version = str(plain["asset"]["version"])
        document = pygltflib.GLTF2.from_json(text.decode())
    except (ValueError, KeyError, TypeError, AttributeError, RecursionError):
        raise CharacterError(f"{path}: not a glTF file; export it as .glb again") from None
    if not version.startswith("2"):
        raise CharacterError(f"{path}: glTF {version}; export it as glTF 2.0")
    unknown = sorted(set(document.extensionsRequired or []) - _UNDERSTOOD)
    if unknown:
        raise CharacterError(
            f"{path}: needs the extension {', '.join(unknown)}; export it without compression"
        )
    opened = GltfFile(path, document, plain, ())
    buffers = tuple(
        blob if buffer.uri is None else opened.resource(buffer.uri) for buffer in document.buffers
    )
    return GltfFile(path, document, plain, buffers)


def _unpack(path: Path, data: bytes) -> tuple[bytes, bytes]:
    """Return the JSON text and the binary chunk."""
    if data[:4] != struct.pack("<I", _MAGIC):
        return data, b""
    if len(data) < 20 or struct.unpack_from("<I", data, 8)[0] > len(data):
        raise CharacterError(f"{path}: truncated .glb; copy or export it again")
    chunks: dict[int, bytes] = {}
    at = 12
    while at + 8 <= len(data):
        length, kind = struct.unpack_from("<II", data, at)
        chunks.setdefault(kind, data[at + 8 : at + 8 + length])
        at += 8 + length
    return chunks.get(_JSON, b""), chunks.get(_BIN, b"")
