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
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import Any, Literal, TypeVar

from robot.protocol.fields import FORMATS, FieldForm, MessageError
from robot.protocol.timing import VERSION

Sender = Literal["host", "robot"]

HEADER = struct.Struct("<BH")
"""Every body begins with the message's number (u8) and the session (u16), little endian."""


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
        layout = struct.Struct("<" + "".join(FORMATS[field.form] for field in own))
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
