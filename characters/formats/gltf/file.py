"""An opened glTF: the arrays in its buffers, and the files that it refers to."""

import base64
from dataclasses import dataclass, field
from errno import ENOENT
from pathlib import Path
from urllib.parse import unquote, unquote_to_bytes, urlsplit

import numpy as np
from numpy.typing import NDArray

from characters.formats.gltf.document import DamagedFileError, Json, at

Array = NDArray[np.float64]

_MOST_ZEROS = 2_000_000  # rows without bytes behind them

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


@dataclass
class Budget:
    """How much may still come out of a file: a few bytes can claim to be gigabytes."""

    numbers: int = 60_000_000
    """Numbers in arrays, over all that is read; half a gigabyte, and more for large files."""

    pixels: int = 64_000_000
    """Of all images together."""

    def spend(self, numbers: int, what: str) -> None:
        """Refuse what would not leave room for the rest."""
        self.numbers -= numbers
        if self.numbers < 0:
            raise DamagedFileError(f"{what} claims more numbers than any character has")

    def spend_pixels(self, pixels: int, what: str) -> None:
        """Refuse a picture that would not leave room for the rest."""
        self.pixels -= pixels
        if self.pixels < 0:
            raise DamagedFileError(f"{what} makes more than 64 million pixels; scale them down")


@dataclass(frozen=True)
class GltfFile:
    """An opened glTF: its document and its bytes."""

    path: Path
    """Where it came from."""

    document: Json
    """The JSON part, checked."""

    buffers: tuple[bytes, ...]
    """Content of each buffer."""

    budget: Budget = field(default_factory=Budget)
    """What may still be read."""

    def all(self, kind: str) -> list[Json]:
        """Return the members of a list at the top of the document, such as "nodes"."""
        return list(self.document.get(kind, ()))

    def floats(self, index: int, width: int) -> Array:
        """Return an accessor's array, (count, width), or (count,) for scalars.

        Integers marked as normalised become numbers of 0…1 or −1…1.
        """
        values = self._accessor(index, width)
        if values.dtype.kind == "f":
            numbers = values.astype(np.float64)
            if not np.isfinite(numbers).all():
                row = int(np.flatnonzero(~np.isfinite(numbers).all(axis=1))[0])
                raise DamagedFileError(f"accessor {index} holds {numbers[row]} in row {row}")
        else:
            numbers = values.astype(np.float64)
            if self.document["accessors"][index].get("normalized"):
                numbers = np.maximum(numbers / np.iinfo(values.dtype.name).max, -1.0)
        return numbers[:, 0] if width == 1 else numbers

    def integers(self, index: int, width: int) -> NDArray[np.int64]:
        """Return an accessor's array of whole numbers, (count, width), or (count,) for scalars."""
        values = self._accessor(index, width)
        if values.dtype.kind != "u":
            raise DamagedFileError(
                f"accessor {index} has {values.dtype} where numbers of things go"
            )
        return values[:, 0].astype(np.int64) if width == 1 else values.astype(np.int64)

    def width(self, index: int) -> int:
        """Return the number of components of an accessor."""
        kind = self.document["accessors"][index]["type"]
        if kind not in WIDTHS:
            raise DamagedFileError(f"accessor {index} is of type {kind!r:.20}")
        return WIDTHS[kind]

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
        """Return what a URI names: data inside it, or a file beside this one."""
        if uri.startswith("data:"):
            kind, _, data = uri.partition(",")
            return base64.b64decode(data) if kind.endswith(";base64") else unquote_to_bytes(data)
        name = unquote(uri)
        if urlsplit(uri).scheme or Path(name).is_absolute():
            raise DamagedFileError(f"needs {name!r:.80}, which is not a file beside it")
        beside = self.path.parent / name
        try:
            if not beside.is_file():  # neither folders nor devices, some of which never end
                raise FileNotFoundError(ENOENT, "no such file")
            return beside.read_bytes()
        except (OSError, ValueError) as error:
            reason = getattr(error, "strerror", None) or error
            raise DamagedFileError(
                f"needs {name!r:.80}, which cannot be read ({reason}); put it beside the file"
            ) from None

    def _accessor(self, index: int, width: int) -> NDArray[np.generic]:
        accessor, own_width = self.document["accessors"][index], self.width(index)
        with at(f"accessor {index}"):
            dtype, count = _component(accessor), accessor["count"]
            if own_width != width:
                raise DamagedFileError(f"is {accessor['type']}, {width} components are needed")
            self.budget.spend(count * width, f"a count of {count}")
            if "bufferView" in accessor:
                offset = accessor.get("byteOffset", 0)
                values = self._strided(accessor["bufferView"], offset, dtype, count, width)
            elif count > _MOST_ZEROS:
                raise DamagedFileError(f"has a count of {count}, and no data")
            else:
                values = np.zeros((count, width), dtype)
            if "sparse" in accessor:
                values = self._with_sparse(values, accessor["sparse"])
        return values

    def _strided(
        self, view: int, offset: int, dtype: "np.dtype[np.generic]", count: int, width: int
    ) -> NDArray[np.generic]:
        data, size = self.view(view), dtype.itemsize * width
        stride = self.document["bufferViews"][view].get("byteStride") or size
        needed = offset + (count - 1) * stride + size if count else 0
        if needed > len(data) or stride < size:
            raise DamagedFileError(
                f"needs {needed} bytes in steps of {stride}, buffer view {view} has {len(data)}"
            )
        if stride == size:
            return np.frombuffer(data, dtype, count * width, offset).reshape(count, width)
        raw = np.frombuffer(data, np.uint8, offset=offset)
        windows = np.lib.stride_tricks.as_strided(raw, (count, size), (stride, 1), writeable=False)
        return np.ascontiguousarray(windows).view(dtype).reshape(count, width)

    def _with_sparse(self, values: NDArray[np.generic], sparse: Json) -> NDArray[np.generic]:
        count, (indices, replacing) = sparse["count"], (sparse["indices"], sparse["values"])
        if count > len(values):
            raise DamagedFileError(f"replaces {count} of {len(values)} rows")
        where = _component(indices)
        rows = self._strided(indices["bufferView"], indices.get("byteOffset", 0), where, count, 1)
        numbers = rows[:, 0].astype(np.int64)
        if ((numbers < 0) | (numbers >= len(values))).any():
            raise DamagedFileError(f"replaces a row beyond its {len(values)}")
        changed = values.copy()
        changed[numbers] = self._strided(
            replacing["bufferView"],
            replacing.get("byteOffset", 0),
            values.dtype,
            count,
            values.shape[1],
        )
        return changed


def _component(holder: Json) -> "np.dtype[np.generic]":
    """Return the type of an accessor's numbers, or of its sparse indices."""
    code = holder["componentType"]
    if code not in COMPONENTS:
        raise DamagedFileError(f"component type {code!r:.20} does not exist")
    return np.dtype(COMPONENTS[code]).newbyteorder("<")
