"""The container of glTF 2.0: .glb with two chunks, or JSON alone."""

import struct
from dataclasses import replace
from pathlib import Path

from characters.errors import CharacterError
from characters.formats.gltf.document import DamagedFileError, at, parse
from characters.formats.gltf.file import Budget, GltfFile
from characters.model.files import read_required_file

_MAGIC, _JSON, _BIN = 0x46546C67, 0x4E4F534A, 0x004E4942

# What changes how bytes are to be read; without it nothing would come out right.
_UNDERSTOOD = {
    "KHR_mesh_quantization",
    "KHR_materials_unlit",
    "KHR_texture_transform",
    "KHR_materials_emissive_strength",
    "VRMC_vrm",
    "VRMC_materials_mtoon",
    "VRM",
}


def open_gltf(path: Path) -> GltfFile:
    """Read a .glb or .gltf file with everything that it refers to.

    Raises
    ------
    CharacterError
        If it is absent, truncated, not glTF 2.0, or needs an extension that is not understood.
    DamagedFileError
        If its JSON or its buffers contradict themselves.
    """
    data = read_required_file(path)
    text, blob = _unpack(path, data)
    try:
        document = parse(text)
    except DamagedFileError:
        raise
    except (ValueError, RecursionError):
        raise CharacterError(f"{path}: not a glTF file; export it as .glb again") from None
    version = str(document["asset"].get("version"))
    if not version.startswith("2"):
        raise CharacterError(f"{path}: glTF {version:.20}; export it as glTF 2.0")
    unknown = sorted(set(document.get("extensionsRequired", ())) - _UNDERSTOOD)
    if unknown:
        raise CharacterError(
            f"{path}: needs the extension {', '.join(unknown)}; export it without compression"
        )
    opened = GltfFile(path, document, (), Budget(60_000_000 + 2 * len(data)))
    buffers: list[bytes] = []
    for number, buffer in enumerate(opened.all("buffers")):
        with at(f"buffer {number}"):
            content = opened.resource(buffer["uri"]) if "uri" in buffer else blob
            if len(content) < buffer["byteLength"]:
                raise DamagedFileError(f"has {len(content)} bytes, not {buffer['byteLength']}")
        buffers.append(content)
    return replace(opened, buffers=tuple(buffers))


def _unpack(path: Path, data: bytes) -> tuple[bytes, bytes]:
    """Return the JSON text and the binary chunk."""
    if data[:4] != struct.pack("<I", _MAGIC):
        return data, b""
    if len(data) < 20 or struct.unpack_from("<I", data, 8)[0] > len(data):
        raise CharacterError(f"{path}: truncated .glb; copy or export it again")
    chunks: dict[int, bytes] = {}
    at_byte = 12
    while at_byte + 8 <= len(data):
        length, kind = struct.unpack_from("<II", data, at_byte)
        chunks.setdefault(kind, data[at_byte + 8 : at_byte + 8 + length])
        at_byte += 8 + length
    return chunks.get(_JSON, b""), chunks.get(_BIN, b"")
