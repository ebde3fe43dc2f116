"""How one field of a message stands on the wire: its type, unit and range."""

import dataclasses
import struct
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, Literal, get_args

Form = Literal["u8", "u16", "u32", "i16", "i16x16", "text16"]

FORMATS: dict[str, str] = {
    "u8": "B",
    "u16": "H",
    "u32": "I",
    "i16": "h",
    "i16x16": "16h",
    "text16": "16s",
}
LIMITS = {"u8": (0, 255), "u16": (0, 65535), "u32": (0, 2**32 - 1), "i16": (-32768, 32767)}
assert set(FORMATS) == set(get_args(Form))


class MessageError(ValueError):
    """A body that was received whole but does not say anything valid."""


@dataclass(frozen=True)
class FieldForm:
    """How one field stands on the wire."""

    name: str
    """Its name, in code and document."""

    form: str
    """Its type there: "u8" … "text16"."""

    scale: float
    """Value of one count, in `unit`; 1 for whole numbers."""

    unit: str
    """Unit of the value; empty for counts and indices."""

    low: float | None
    """Smallest value allowed, in `unit`; None for all that the form can hold."""

    high: float | None
    """Largest value allowed, in `unit`."""

    meaning: str
    """What it says."""

    since: int = 1
    """Version of the protocol that brought it."""

    @property
    def size(self) -> int:
        """Bytes on the wire."""
        return struct.calcsize("<" + FORMATS[self.form])

    @cached_property
    def count(self) -> int:
        """Values that it takes from a struct of the whole message."""
        return 16 if self.form == "i16x16" else 1

    @cached_property
    def limits(self) -> tuple[int, int]:
        """Smallest and largest count allowed."""
        smallest, largest = LIMITS[self.form.removesuffix("x16")]
        low = smallest if self.low is None else round(self.low / self.scale)
        high = largest if self.high is None else round(self.high / self.scale)
        return low, high

    @cached_property
    def per_unit(self) -> int:
        """Counts in one unit."""
        return round(1 / self.scale)

    def to_wire(self, value: Any) -> list[Any]:
        """Turn a value into what `struct` packs; raises ValueError where it does not fit."""
        if self.form == "text16":
            text = str(value).encode()
            if len(text) > 16 or b"\0" in text:
                raise ValueError(f"{self.name} must be at most 16 bytes of UTF-8, not {value!r}")
            return [text]
        values = list(value) if self.form == "i16x16" else [value]
        if len(values) != self.count:
            raise ValueError(f"{self.name} must have {self.count} values, not {len(values)}")
        scale = self.scale
        counts = [round(one / scale) for one in values]
        self._check(counts, ValueError)
        return counts

    def from_wire(self, values: tuple[Any, ...]) -> Any:
        """Turn what `struct` unpacked into a value; raises MessageError where it is not allowed."""
        if self.form == "text16":
            try:
                return values[0].partition(b"\0")[0].decode()
            except UnicodeDecodeError:
                raise MessageError(f"{self.name} is not UTF-8") from None
        self._check(values, MessageError)
        per = self.per_unit
        if self.form == "i16x16":
            return tuple([one / per for one in values])
        return values[0] if self.scale == 1 else values[0] / per

    def _check(self, counts: Sequence[int], error: type[ValueError]) -> None:
        low, high = self.limits
        for count in counts:
            if not low <= count <= high:
                least, most, value = (n * self.scale for n in (low, high, count))
                raise error(f"{self.name} must be from {least:g} to {most:g}, not {value:g}")


def wire(
    form: Form,
    meaning: str,
    *,
    scale: float = 1,
    unit: str = "",
    low: float | None = None,
    high: float | None = None,
    since: int = 1,
    default: Any = dataclasses.MISSING,
) -> Any:
    """Return a dataclass field that knows its form on the wire.

    A field that a later version added needs a default: what is meant where it is missing.
    """
    assert since == 1 or default is not dataclasses.MISSING
    known = (form, scale, unit, low, high, meaning, since)
    return dataclasses.field(default=default, metadata={"wire": known})
