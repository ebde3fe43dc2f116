"""The wire form of one message field: its type, unit and range."""

import dataclasses
import struct
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, Literal, get_args

WireType = Literal["u8", "u16", "u32", "i16", "i16x16", "text16", "text80"]

STRUCT_CODES: dict[str, str] = {
    "u8": "B",
    "u16": "H",
    "u32": "I",
    "i16": "h",
    "i16x16": "16h",
    "text16": "16s",
    "text80": "80s",
}
INTEGER_LIMITS = {
    "u8": (0, 255),
    "u16": (0, 65535),
    "u32": (0, 2**32 - 1),
    "i16": (-32768, 32767),
}
assert set(STRUCT_CODES) == set(get_args(WireType))


class MessageError(ValueError):
    """A body of a valid frame that holds no valid message."""


@dataclass(frozen=True)
class FieldSpec:
    """The wire form of one field."""

    name: str
    """Its name, in code and document."""

    wire_type: str
    """Its type on the wire: "u8" … "text80"."""

    scale: float
    """Value of one count, in `unit`; 1 for integers."""

    unit: str
    """Unit of the value; empty for counts and indices."""

    low: float | None
    """Smallest value allowed, in `unit`; None for the limit of the type."""

    high: float | None
    """Largest value allowed, in `unit`."""

    meaning: str
    """Its description in the document."""

    since: int = 1
    """Version of the protocol that added it."""

    @property
    def size(self) -> int:
        """Bytes on the wire."""
        return struct.calcsize("<" + STRUCT_CODES[self.wire_type])

    @property
    def is_text(self) -> bool:
        """Whether its value is a text, padded with zero bytes."""
        return self.wire_type.startswith("text")

    @cached_property
    def count(self) -> int:
        """Number of values that `struct` unpacks for it."""
        return 16 if self.wire_type == "i16x16" else 1

    @cached_property
    def limits(self) -> tuple[int, int]:
        """Smallest and largest count allowed."""
        smallest, largest = INTEGER_LIMITS[self.wire_type.removesuffix("x16")]
        low = smallest if self.low is None else round(self.low / self.scale)
        high = largest if self.high is None else round(self.high / self.scale)
        return low, high

    @cached_property
    def per_unit(self) -> int:
        """Counts on the wire for one unit: the inverse of `scale`, exact."""
        return round(1 / self.scale)

    def to_wire(self, value: Any) -> list[Any]:
        """Return what `struct` packs for a value; raises ValueError if it does not fit."""
        if self.is_text:
            text = str(value).encode()
            if len(text) > self.size or b"\0" in text:
                most = f"at most {self.size} bytes of UTF-8"
                raise ValueError(f"{self.name} must be {most}, not {value!r}")
            return [text]
        values = list(value) if self.wire_type == "i16x16" else [value]
        if len(values) != self.count:
            raise ValueError(f"{self.name} must have {self.count} values, not {len(values)}")
        counts = [round(number / self.scale) for number in values]
        self._check(counts, ValueError)
        return counts

    def from_wire(self, values: tuple[Any, ...]) -> Any:
        """Return the value that `struct` unpacked; raises MessageError if it is not allowed."""
        if self.is_text:
            try:
                return values[0].partition(b"\0")[0].decode()
            except UnicodeDecodeError:
                raise MessageError(f"{self.name} is not UTF-8") from None
        self._check(values, MessageError)
        per_unit = self.per_unit
        if self.wire_type == "i16x16":
            return tuple([count / per_unit for count in values])
        return values[0] if self.scale == 1 else values[0] / per_unit

    def _check(self, counts: Sequence[int], error: type[ValueError]) -> None:
        low, high = self.limits
        for count in counts:
            if not low <= count <= high:
                least, most, value = (n * self.scale for n in (low, high, count))
                raise error(f"{self.name} must be from {least:g} to {most:g}, not {value:g}")


def wire_field(
    wire_type: WireType,
    meaning: str,
    *,
    scale: float = 1,
    unit: str = "",
    low: float | None = None,
    high: float | None = None,
    since: int = 1,
    default: Any = dataclasses.MISSING,
) -> Any:
    """Return a dataclass field with its wire form.

    A field that a later version added needs a default for messages without it.
    """
    assert since == 1 or default is not dataclasses.MISSING
    spec = (wire_type, scale, unit, low, high, meaning, since)
    return dataclasses.field(default=default, metadata={"wire": spec})
