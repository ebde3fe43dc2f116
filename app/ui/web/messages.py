"""What the page and the program tell each other over a WebSocket.

Pictures and sound are binary: a head of a fixed form, and the data. All else is JSON.
"""

import struct
from typing import Literal

import msgspec

from cubeling.app.errors import AppError

HEAD = struct.Struct("<BxxxId")
"""Of a binary message: its kind, its number, and a time of the page's clock [s]."""

PICTURE, SOUND, TILE = 1, 2, 3
"""Kinds: a picture (JPEG, or WebP with transparency), sound (16 bits, stereo), and the picture of
the scenario of that number (JPEG)."""

Role = Literal["play", "camera", "window", "view"]
"""What a page is: camera and window, one of both, or a picture that nobody touches."""

CAMERA_ROLES: tuple[Role, ...] = ("play", "camera")
"""The roles whose camera may be that of the session."""

PLAYER_ROLES: tuple[Role, ...] = ("play", "camera", "window")
"""The roles that may ask something of the session."""


class Said(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """A message in JSON from a page."""

    do: Literal[
        "tick",
        "shown",
        "camera",
        "play",
        "again",
        "snapshot",
        "record",
        "mark",
        "type",
        "answer",
        "done",
    ]
    """What it says: that it is there, that it has shown a picture, that it has a camera; what the
    player asks for; or what a participant of a study answers, or that a task is done."""

    id: int = 0
    """Number of the picture that was shown, or of what is answered."""

    name: str = ""
    """The camera ("ab12-back"), the scenario, the answer, or what is typed for the character: "" as
    that begins."""

    mirror: bool = False
    """Whether the picture of its camera is to be as in a mirror."""

    take: bool = False
    """Whether its camera takes the place of another page's."""


_decoder = msgspec.json.Decoder(Said)


def read_said(text: str) -> Said:
    """Read a message in JSON; raises AppError."""
    try:
        return _decoder.decode(text)
    except (msgspec.MsgspecError, UnicodeError) as error:
        raise AppError(f"a message that is none of ours: {error}") from error


def pack(kind: int, number: int, time: float, data: bytes) -> bytes:
    """Return a binary message."""
    return HEAD.pack(kind, number & 0xFFFFFFFF, time) + data


def unpack(message: bytes) -> tuple[int, int, float, bytes]:
    """Return kind, number, time and data of a binary message; raises AppError.

    >>> unpack(pack(PICTURE, 7, 1.5, b"jpeg"))
    (1, 7, 1.5, b'jpeg')
    """
    if len(message) < HEAD.size:
        raise AppError("a binary message that is too short")
    kind, number, time = HEAD.unpack_from(message)
    if kind != PICTURE or not abs(time) < 1e12:
        raise AppError("a binary message that is no picture")
    return kind, number, time, message[HEAD.size :]
