"""Opening a .glb or .gltf, and the arrays in its buffers."""

import base64
import json
import struct
import warnings
from dataclasses import dataclass, field, replace
from pathlib import Path
from urllib.parse import unquote, unquote_to_bytes, urlsplit

import numpy as np
from numpy.typing import NDArray

from cubeling.characters.errors import CharacterError, CharacterWarning
from cubeling.characters.formats.gltf.document import DamagedFileError, Json, error_context, parse
from cubeling.characters.skeleton.pose import Array
from cubeling.files import FileKind

GLTF_FILE = FileKind(
    "model",
    (".glb", ".gltf", ".vrm", ".vrma"),
    CharacterError,
    1 << 30,
    "cubeling.characters.model.character:Character.load",
)
"""A .glb, .gltf or .vrm file, or a buffer or picture beside it."""

MAGIC, JSON_CHUNK, BIN_CHUNK = 0x46546C67, 0x4E4F534A, 0x004E4942
_MOST_WARNINGS = 4  # of one file about its schema
_MAX_EMPTY_ROWS = 2_000_000  # of an accessor without data

# Extensions that may be required; others change how the data must be read.
_SUPPORTED_EXTENSIONS = {
    "KHR_draco_mesh_compression",
    "KHR_mesh_quantization",
    "KHR_materials_unlit",
    "KHR_texture_transform",
    "EXT_texture_webp",
    "KHR_materials_emissive_strength",
    "VRMC_vrm",
    "VRMC_vrm_animation",
    "VRMC_materials_mtoon",
    "VRMC_springBone",
    "VRMC_node_constraint",
    "VRM",
}

_BASIS = "KHR_texture_basisu"
_KTX_SOFTWARE = "https://github.com/KhronosGroup/KTX-Software/releases"
_ONLY_LOOKS = ("KHR_materials_", "KHR_lights_", "EXT_texture_", "KHR_texture_", "MSFT_texture_")
"""How extensions begin without which a character can be drawn, in plainer colours."""

COMPONENT_TYPES: dict[int, type[np.generic]] = {
    5120: np.int8,
    5121: np.uint8,
    5122: np.int16,
    5123: np.uint16,
    5125: np.uint32,
    5126: np.float32,
}
"""NumPy type of an accessor's componentType."""

TYPE_WIDTHS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4, "MAT2": 4, "MAT3": 9, "MAT4": 16}
"""Number of components of an accessor's type."""


@dataclass
class ReadBudget:
    """How much may still be read from a file, since a few bytes can claim to be gigabytes."""

    numbers: int = 60_000_000
    """Numbers in all arrays: half a gigabyte, and more for large files."""

    pixels: int = 64_000_000
    """Pixels of all images together."""

    def spend(self, numbers: int, what: str) -> None:
        """Refuse an array beyond the budget."""
        self.numbers -= numbers
        if self.numbers < 0:
            raise DamagedFileError(f"{what} claims more numbers than any character has")

    def spend_pixels(self, pixels: int, what: str) -> None:
        """Refuse an image beyond the budget."""
        self.pixels -= pixels
        if self.pixels < 0:
            raise DamagedFileError(f"{what} makes more than 64 million pixels; scale them down")


@dataclass(frozen=True)
class GltfFile:
    """An opened glTF: its document and its bytes."""

    path: Path
    """The file itself, to which the URIs of its buffers are relative."""

    document: Json
    """The JSON part, checked against the schema."""

    buffers: tuple[bytes, ...]
    """Content of each buffer."""

    budget: ReadBudget = field(default_factory=ReadBudget)
    """Limits of what may still be read."""

    def all(self, kind: str) -> list[Json]:
        """Return the members of a list at the top of the document, such as "nodes"."""
        return list(self.document.get(kind, ()))

    def warn(self, repair: str) -> None:
        """Warn of what is left out or repaired, in one line whatever names the file has."""
        line = " ".join(f"{self.path}: {repair}".split())
        warnings.warn(line, CharacterWarning, stacklevel=2)

    def scene_extra(self, name: str) -> object:
        """Return what the first scene with such an extra says, as our own writer states it."""
        for scene in self.all("scenes"):
            extras = scene.get("extras")
            if isinstance(extras, dict) and name in extras:
                return extras[name]
        return None

    def floats(self, index: int, width: int) -> Array:
        """Return an accessor's array, (count, width), or (count,) for scalars.

        Normalised integers become numbers of 0…1 or −1…1.
        """
        values = self._accessor(index, width)
        numbers = values.astype(np.float64)
        if not np.isfinite(numbers).all():
            row = int(np.flatnonzero(~np.isfinite(numbers).all(axis=1))[0])
            raise DamagedFileError(f"accessor {index} holds {numbers[row]} in row {row}")
        if values.dtype.kind != "f" and self.document["accessors"][index].get("normalized"):
            numbers = np.maximum(numbers / np.iinfo(values.dtype.name).max, -1.0)
        return numbers[:, 0] if width == 1 else numbers

    def integers(self, index: int, width: int) -> NDArray[np.int64]:
        """Return an accessor's array of indices, (count, width), or (count,) for scalars."""
        values = self._accessor(index, width)
        if values.dtype.kind != "u":
            raise DamagedFileError(
                f"accessor {index} has {values.dtype} components where indices are needed"
            )
        return values[:, 0].astype(np.int64) if width == 1 else values.astype(np.int64)

    def width(self, index: int) -> int:
        """Return the number of components of an accessor."""
        kind = self.document["accessors"][index]["type"]
        if kind not in TYPE_WIDTHS:
            raise DamagedFileError(f"accessor {index} is of type {kind!r:.20}")
        return TYPE_WIDTHS[kind]

    def view(self, index: int) -> memoryview:
        """Return the bytes of a buffer view."""
        view = self.document["bufferViews"][index]
        buffer, start = self.buffers[view["buffer"]], view.get("byteOffset", 0)
        if start + view["byteLength"] > len(buffer):
            raise DamagedFileError(
                f"buffer view {index} ends at byte {start + view['byteLength']} of a buffer "
                f"of {len(buffer)}"
            )
        return memoryview(buffer)[start : start + view["byteLength"]]

    def resource(self, uri: str) -> bytes:
        """Return the content of a data URI, or of a file in the same folder."""
        if uri.startswith("data:"):
            kind, _, data = uri.partition(",")
            return base64.b64decode(data) if kind.endswith(";base64") else unquote_to_bytes(data)
        name = unquote(uri)
        if urlsplit(uri).scheme or Path(name).is_absolute():
            raise DamagedFileError(f"needs {name!r:.80}, which is not in the same folder")
        try:
            return GLTF_FILE.read(self.path.parent / name)
        except CharacterError as error:
            raise DamagedFileError(f"needs {name!r:.80}: {error}") from None

    def _accessor(self, index: int, width: int) -> NDArray[np.generic]:
        accessor, own_width = self.document["accessors"][index], self.width(index)
        with error_context(f"accessor {index}"):
            dtype, count = _component(accessor), accessor["count"]
            if own_width != width:
                raise DamagedFileError(f"is {accessor['type']}, {width} components are needed")
            self.budget.spend(count * width, f"a count of {count}")
            if "bufferView" in accessor:
                offset = accessor.get("byteOffset", 0)
                values = self._strided_view(accessor["bufferView"], offset, dtype, count, width)
            elif count > _MAX_EMPTY_ROWS:
                raise DamagedFileError(f"has a count of {count}, and no data")
            else:
                values = np.zeros((count, width), dtype)
            if "sparse" in accessor:
                values = self._with_sparse(values, accessor["sparse"])
        return values

    def _strided_view(
        self, view: int, offset: int, dtype: "np.dtype[np.generic]", count: int, width: int
    ) -> NDArray[np.generic]:
        data, size = self.view(view), dtype.itemsize * width
        stride = self.document["bufferViews"][view].get("byteStride") or size
        needed = offset + (count - 1) * stride + size if count else 0
        if needed > len(data) or stride < size:
            raise DamagedFileError(
                f"needs {needed} bytes in steps of {stride}, buffer view {view} has {len(data)}"
            )
        return np.ndarray((count, width), dtype, data, offset, (stride, dtype.itemsize))

    def _with_sparse(self, values: NDArray[np.generic], sparse: Json) -> NDArray[np.generic]:
        count, (indices, replacing) = sparse["count"], (sparse["indices"], sparse["values"])
        if count > len(values):
            raise DamagedFileError(f"replaces {count} of {len(values)} rows")
        where = _component(indices)
        rows = self._strided_view(
            indices["bufferView"], indices.get("byteOffset", 0), where, count, 1
        )
        numbers = rows[:, 0].astype(np.int64)
        if ((numbers < 0) | (numbers >= len(values))).any():
            raise DamagedFileError(f"replaces a row beyond its {len(values)}")
        changed, offset = values.copy(), replacing.get("byteOffset", 0)
        changed[numbers] = self._strided_view(
            replacing["bufferView"], offset, values.dtype, count, values.shape[1]
        )
        return changed


def _component(holder: Json) -> "np.dtype[np.generic]":
    """Return the type of an accessor's numbers, or of its sparse indices."""
    code = holder["componentType"]
    if code not in COMPONENT_TYPES:
        raise DamagedFileError(f"component type {code!r:.20} does not exist")
    return np.dtype(COMPONENT_TYPES[code]).newbyteorder("<")


def open_gltf(path: Path, content: bytes | None = None) -> GltfFile:
    """Read a .glb or .gltf file with its buffers; refuse extensions that are not supported.

    `content` is what a file of another format was converted to.
    """
    data = GLTF_FILE.read(path) if content is None else content
    text, blob = _unpack(path, data)
    try:
        document, left_out = parse(text)
    except DamagedFileError:
        raise
    except (ValueError, RecursionError):
        raise CharacterError(f"{path}: not a glTF file; export it as .glb again") from None
    version = str(document["asset"].get("version"))
    if not version.startswith("2"):
        raise CharacterError(f"{path}: glTF {version:.20}; export it as glTF 2.0")
    required = sorted(set(document.get("extensionsRequired", ())) - _SUPPORTED_EXTENSIONS)
    unknown = [name for name in required if not name.startswith(_ONLY_LOOKS)]
    if unknown:
        advice = {_advice(extension, path, document) for extension in unknown}
        raise CharacterError(
            f"{path}: requires the extension {', '.join(unknown)}; {'; '.join(sorted(advice))}"
        )
    opened = GltfFile(path, document, (), ReadBudget(60_000_000 + 2 * len(data)))
    looks = [name for name in required if name.startswith(_ONLY_LOOKS)]
    if looks:
        opened.warn(f"it is drawn without {', '.join(looks)}, which it requires")
    for wrong in left_out[:_MOST_WARNINGS]:
        opened.warn(f"{wrong}; left it out")
    if len(left_out) > _MOST_WARNINGS:
        opened.warn(f"{len(left_out) - _MOST_WARNINGS} more like this were left out")
    buffers: list[bytes] = []
    for number, buffer in enumerate(opened.all("buffers")):
        with error_context(f"buffer {number}"):
            content = opened.resource(buffer["uri"]) if "uri" in buffer else blob
            if len(content) < buffer["byteLength"]:
                raise DamagedFileError(f"has {len(content)} bytes, not {buffer['byteLength']}")
        buffers.append(content)
    return replace(opened, buffers=tuple(buffers))


def _advice(extension: str, path: Path, document: Json) -> str:
    """Return what makes a file do without an extension."""
    if not extension.endswith("_meshopt_compression"):
        return "export it without"
    if _BASIS in document.get("extensionsRequired", ()):
        return without_ktx(path, document)
    if _states_vrm(document):
        return "export it without compression"  # the tool below drops what it does not know
    return f"unpack it: npx @gltf-transform/cli copy {path.name} unpacked.glb"


def without_ktx(path: Path, document: Json) -> str:
    """Return what gives a file PNG textures instead of KTX2; the command unpacks meshes too."""
    if _states_vrm(document):
        return "export it with PNG, JPEG or WebP textures"
    # Without ktx, which no package manager has, the command fails with a riddle.
    return (
        f"convert it: npx @gltf-transform/cli ktxdecompress {path.name} unpacked.glb "
        f"(it calls ktx of KTX-Software: {_KTX_SOFTWARE})"
    )


def _states_vrm(document: Json) -> bool:
    return any(name.startswith("VRM") for name in document.get("extensions", {}))


def has_mesh(path: Path) -> bool:
    """Return whether a file has a mesh; one that cannot be read is said to have one."""
    try:
        text, _ = _unpack(path, GLTF_FILE.read(path))
        document = json.loads(text)
    except (CharacterError, ValueError, RecursionError):
        return True
    return not isinstance(document, dict) or "asset" not in document or bool(document.get("meshes"))


def _unpack(path: Path, data: bytes) -> tuple[bytes, bytes]:
    """Return the JSON text and the binary chunk."""
    if data[:4] != struct.pack("<I", MAGIC):
        return data, b""
    if len(data) < 20 or struct.unpack_from("<I", data, 8)[0] > len(data):
        raise CharacterError(f"{path}: truncated .glb; copy or export it again")
    chunks: dict[int, bytes] = {}
    position = 12
    while position + 8 <= len(data):
        length, kind = struct.unpack_from("<II", data, position)
        chunks.setdefault(kind, data[position + 8 : position + 8 + length])
        position += 8 + length
    return chunks.get(JSON_CHUNK, b""), chunks.get(BIN_CHUNK, b"")
