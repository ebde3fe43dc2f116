"""The schema of messages: codec, document, C header and test vectors come from one declaration.

A message is a frozen dataclass whose fields hold their wire form::

    @message(0x11, "host", "...")
    @dataclass(frozen=True)
    class Express:
        valence: float = wire_field("i16", "...", scale=1e-4, low=-1, high=1, unit="1")

A later version appends fields, each with the version that added it and a default for messages of
earlier versions.
"""

import dataclasses
import struct
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import Any, Literal, TypeVar

from cubeling.robot.protocol.fields import STRUCT_CODES, FieldSpec, MessageError
from cubeling.robot.protocol.timing import VERSION

Sender = Literal["host", "robot"]

HEADER = struct.Struct("<BH")
"""Start of every body: the message number (u8) and the session (u16), little endian."""


@dataclass(frozen=True)
class MessageSpec:
    """The wire form of one message."""

    number: int
    """The first byte of its body."""

    name: str
    """Its name in the document, in capitals."""

    sender: Sender
    """Who may send it."""

    meaning: str
    """Its description in the document."""

    fields: tuple[FieldSpec, ...]
    """Its fields in wire order, those of all versions."""

    kind: type[Any]
    """The dataclass that the codec makes of a body."""

    parts: tuple["VersionPart", ...]
    """The fields of its first version, then those that each later version added."""

    since: int = 1
    """Version of the protocol that added it."""

    @property
    def size(self) -> int:
        """Bytes of the body in the first version, header included."""
        return self.parts[0].end

    def parts_of(self, version: int) -> tuple["VersionPart", ...]:
        """Return the parts of a version; at least the first."""
        return tuple(part for part in self.parts if part.since <= version)

    def size_in(self, version: int) -> int:
        """Return the bytes of the body in a version, header included; 0 if it lacks the message."""
        return self.parts_of(version)[-1].end if version >= self.since else 0


@dataclass(frozen=True)
class VersionPart:
    """The fields of a message that one version added; packed without gaps, little endian."""

    since: int
    """Version of the protocol that added the fields."""

    fields: tuple[FieldSpec, ...]
    """Its fields in wire order, none of other versions."""

    layout: struct.Struct
    """Little endian, without padding."""

    start: int
    """Offset in the body [bytes]."""

    @cached_property
    def end(self) -> int:
        """Offset of their end in the body [bytes]."""
        return self.start + self.layout.size

    def unpack(self, body: bytes) -> dict[str, Any]:
        """Return the values by name; raises MessageError if one is not allowed."""
        values = self.layout.unpack_from(body, self.start)
        content = {}
        start = 0
        for field in self.fields:
            end = start + field.count
            content[field.name] = field.from_wire(values[start:end])
            start = end
        return content

    def pack(self, content: Any) -> bytes:
        """Return the bytes; raises ValueError if a value does not fit."""
        values: list[Any] = []
        for field in self.fields:
            values += field.to_wire(getattr(content, field.name))
        return self.layout.pack(*values)


MESSAGES: dict[int, MessageSpec] = {}
"""Every message by its number."""

_BY_KIND: dict[type[Any], MessageSpec] = {}

Kind = TypeVar("Kind")


def message(
    number: int, sender: Sender, meaning: str, since: int = 1
) -> Callable[[type[Kind]], type[Kind]]:
    """Register a dataclass in `MESSAGES`."""

    def register(kind: type[Kind]) -> type[Kind]:
        fields = tuple(
            FieldSpec(field.name, *field.metadata["wire"])
            for field in dataclasses.fields(kind)  # type: ignore[arg-type] # it is a dataclass
        )
        name = kind.__name__.upper()
        spec = MessageSpec(number, name, sender, meaning, fields, kind, _parts_of(fields), since)
        assert number not in MESSAGES, f"message number {number:#x} is used twice"
        MESSAGES[number] = _BY_KIND[kind] = spec
        return kind

    return register


def _parts_of(fields: tuple[FieldSpec, ...]) -> tuple[VersionPart, ...]:
    versions = sorted({1, *(field.since for field in fields)})
    assert [field.since for field in fields] == sorted(field.since for field in fields)
    parts: list[VersionPart] = []
    for version in versions:
        own = tuple(field for field in fields if field.since == version)
        layout = struct.Struct("<" + "".join(STRUCT_CODES[field.wire_type] for field in own))
        parts.append(VersionPart(version, own, layout, parts[-1].end if parts else HEADER.size))
    return tuple(parts)


def spec_of(kind: type[Any]) -> MessageSpec:
    """Return the wire form of a message class."""
    return _BY_KIND[kind]


def pack(content: Any, session: int, version: int = VERSION) -> bytes:
    """Return the body of a message in a version; raises ValueError if a field is out of range."""
    spec = _BY_KIND[type(content)]
    body = HEADER.pack(spec.number, session)
    for part in spec.parts_of(version):
        body += part.pack(content)
    return body


def unpack(body: bytes, sender: Sender) -> tuple[int, Any]:
    """Return the session and the message of a body, None if it is unknown or not of `sender`.

    Bytes after the last known field are ignored: a later version added them. The fields that a
    version added have their defaults unless all of them are there: the peer may be older.

    Raises MessageError if the body is shorter than its message, or a field is out of range.
    """
    if len(body) < HEADER.size:
        raise MessageError("shorter than a header")
    number, session = HEADER.unpack_from(body)
    spec = MESSAGES.get(number)
    if spec is None or spec.sender != sender:
        return session, None
    if len(body) < spec.size:
        raise MessageError(f"{spec.name} has {spec.size} bytes, not {len(body)}")
    content: dict[str, Any] = {}
    for part in spec.parts:
        if part.end <= len(body):
            content |= part.unpack(body)
    return session, spec.kind(**content)
