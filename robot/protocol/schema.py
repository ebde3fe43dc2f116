"""How a message is written down once and becomes a codec, a table in the document and its vectors.

A message is a frozen dataclass whose fields carry their form on the wire::

    @message(0x11, "host", "...")
    @dataclass(frozen=True)
    class Express:
        valence: float = wire("i16", scale=1e-4, low=-1, high=1, unit="1", meaning="...")

A later version adds fields behind the last one, each with the version that brought it and a default
for those who do not know it.
"""

import dataclasses
import struct
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, Literal, TypeVar, get_args

from robot.protocol.timing import VERSION

Sender = Literal["host", "robot"]
Form = Literal["u8", "u16", "u32", "i16", "i16x16", "text16"]

HEADER = struct.Struct("<BH")
"""Every body begins with the message's number (u8) and the session (u16), little endian."""

_FORMATS: dict[str, str] = {
    "u8": "B",
    "u16": "H",
    "u32": "I",
    "i16": "h",
    "i16x16": "16h",
    "text16": "16s",
}
LIMITS = {"u8": (0, 255), "u16": (0, 65535), "u32": (0, 2**32 - 1), "i16": (-32768, 32767)}
assert set(_FORMATS) == set(get_args(Form))


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
        return struct.calcsize("<" + _FORMATS[self.form])

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


@dataclass(frozen=True)
class MessageForm:
    """How one message stands on the wire."""

    number: int
    """The first byte of its body."""

    name: str
    """Its name in the document, in capitals."""

    sender: Sender
    """Who may send it."""

    meaning: str
    """What it is for."""

    fields: tuple[FieldForm, ...]
    """In the order in which they are sent."""

    kind: type[Any]
    """The dataclass."""

    parts: tuple["Part", ...]
    """The fields of the first version that has it, then what each later version added."""

    @property
    def size(self) -> int:
        """Bytes of the body in its first version, header included."""
        return self.parts[0].end

    def known(self, version: int) -> tuple["Part", ...]:
        """Return the parts that a version has; the first at least."""
        return tuple(part for part in self.parts if part.since <= version) or self.parts[:1]


@dataclass(frozen=True)
class Part:
    """The fields of a message that one version brought; packed without gaps, little endian."""

    since: int
    """That version."""

    fields: tuple[FieldForm, ...]
    """In the order in which they are sent."""

    layout: struct.Struct
    """All of them."""

    start: int
    """Where they begin in the body [bytes]."""

    @cached_property
    def end(self) -> int:
        """Where they end in the body [bytes]."""
        return self.start + self.layout.size

    def unpack(self, body: bytes) -> dict[str, Any]:
        """Return the values by name; raises MessageError where one is not allowed."""
        values = self.layout.unpack_from(body, self.start)
        content = {}
        start = 0
        for field in self.fields:
            end = start + field.count
            content[field.name] = field.from_wire(values[start:end])
            start = end
        return content

    def pack(self, content: Any) -> bytes:
        """Return the bytes; raises ValueError where a value does not fit."""
        values: list[Any] = []
        for field in self.fields:
            values += field.to_wire(getattr(content, field.name))
        return self.layout.pack(*values)


FORMS: dict[int, MessageForm] = {}
"""Every message by its number: the one table."""

_BY_KIND: dict[type[Any], MessageForm] = {}

Kind = TypeVar("Kind")


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


def message(number: int, sender: Sender, meaning: str) -> Callable[[type[Kind]], type[Kind]]:
    """Enter a dataclass into the table of messages."""

    def enter(kind: type[Kind]) -> type[Kind]:
        fields = tuple(
            FieldForm(field.name, *field.metadata["wire"])
            for field in dataclasses.fields(kind)  # type: ignore[arg-type] # it is a dataclass
        )
        name = kind.__name__.upper()
        form = MessageForm(number, name, sender, meaning, fields, kind, _parts_of(fields))
        assert number not in FORMS, f"message number {number:#x} is used twice"
        FORMS[number] = _BY_KIND[kind] = form
        return kind

    return enter


def _parts_of(fields: tuple[FieldForm, ...]) -> tuple[Part, ...]:
    versions = sorted({1, *(field.since for field in fields)})
    assert [field.since for field in fields] == sorted(field.since for field in fields)
    parts: list[Part] = []
    for version in versions:
        own = tuple(field for field in fields if field.since == version)
        layout = struct.Struct("<" + "".join(_FORMATS[field.form] for field in own))
        parts.append(Part(version, own, layout, parts[-1].end if parts else HEADER.size))
    return tuple(parts)


def form_of(kind: type[Any]) -> MessageForm:
    """Return the form of a message class."""
    return _BY_KIND[kind]


def pack(content: Any, session: int, version: int = VERSION) -> bytes:
    """Return the body for one message, as `version` has it.

    Raises
    ------
    ValueError
        If a field is out of its range.
    """
    form = _BY_KIND[type(content)]
    body = HEADER.pack(form.number, session)
    for part in form.known(version):
        body += part.pack(content)
    return body


def unpack(body: bytes, sender: Sender) -> tuple[int, Any]:
    """Return the session and the message of a body.

    Bytes after the last field that this version knows are skipped: a later version put them there.
    Where the fields that a version added are not all there, they have their defaults: the other end
    speaks an earlier one.

    Parameters
    ----------
    body
        What a frame held.
    sender
        Who is at the other end. What only the own side may say is an echo, and no message.

    Returns
    -------
    tuple
        The session, and the message or None if this version does not know it.

    Raises
    ------
    MessageError
        If the body is shorter than its message, or a field is out of its range.
    """
    if len(body) < HEADER.size:
        raise MessageError("shorter than a header")
    number, session = HEADER.unpack_from(body)
    form = FORMS.get(number)
    if form is None or form.sender != sender:
        return session, None
    if len(body) < form.size:
        raise MessageError(f"{form.name} has {form.size} bytes, not {len(body)}")
    content: dict[str, Any] = {}
    for part in form.parts:
        if part.end <= len(body):
            content |= part.unpack(body)
    return session, form.kind(**content)
