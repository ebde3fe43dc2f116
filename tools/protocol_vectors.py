"""Test vectors for authors of robots: messages with their bytes, and bytes without a message."""

import json
from dataclasses import asdict, dataclass, replace

from cubeling.robot.protocol import messages as m
from cubeling.robot.protocol.schema import pack, spec_of
from cubeling.robot.protocol.timing import VERSION
from cubeling.robot.protocol.wire import MAX_BODY, check_bytes, encode_frame


@dataclass(frozen=True)
class Vector:
    """A message and its frame."""

    session: int
    """The session in its header."""

    content: object
    """The message."""

    version: int = VERSION
    """The protocol version of its encoding."""

    @property
    def body(self) -> bytes:
        """The content of its frame."""
        return pack(self.content, self.session, self.version)

    @property
    def frame(self) -> bytes:
        """Its bytes on the wire, delimiters included."""
        return encode_frame(self.body)


_WELCOME = m.Welcome(
    VERSION, 0, 0xBEEF, 14, 8, 6, 3, "Dino", "simulator 1", abilities=m.ABILITY_MOVE
)
_STATE = m.State(513, 4, m.FLAG_STILL, 0.8, -0.25, 0.5, 1, m.NOTHING, 1, (0.0, -1.571, *[0.0] * 14))

VECTORS = (
    Vector(1, m.Hello(VERSION, 0x12345678)),
    Vector(1, m.Ask(m.ITEM_MOTION, 2)),
    Vector(1, m.Beat(513)),
    Vector(0xABCD, m.Express(1, 0.8, -0.25, 1)),
    Vector(0xABCD, m.Express(1, 0.8, -0.25), version=1),
    Vector(0xABCD, m.Express(2, 0.0, 0.0)),
    Vector(0xABCD, m.Play(3, m.ITEM_SOUND, 0)),
    Vector(0xABCD, m.Stop(4)),
    Vector(0xABCD, m.Move(5, 1.5, 0b10, 0b1_0000_0000, (*[0.0] * 8, -0.262, *[0.0] * 7))),
    Vector(0xABCD, m.Bye()),
    Vector(1, _WELCOME),
    Vector(1, replace(_WELCOME, version=2, abilities=0), version=2),
    Vector(1, m.Joint(8, -0.262, 0.262, 0.349, "torso")),
    Vector(1, m.Name(m.ITEM_MOOD, 1, "happy")),
    Vector(0xABCD, replace(_STATE, time=0xFFFFFFF0, result=m.RESULT_OUT_OF_RANGE, held=0x100)),
    Vector(0xABCD, _STATE, version=2),
    Vector(0xABCD, m.Log(65535, 3_600_000, m.SEVERITY_WARNING, "neck: 61 °C")),
    Vector(0xABCD, m.Ack(4, m.RESULT_TAKEN)),
    Vector(0xABCD, m.Ack(5, m.RESULT_OUT_OF_RANGE)),
    Vector(7, m.Gone()),
)
"""At least one frame of every message, and of every version that extended it."""


_LEVEL = (0.0,) * m.JOINTS_MAX


def broken() -> list[tuple[str, bytes]]:
    """Return byte strings without a message for a robot, and the reasons."""
    beat = Vector(0xABCD, m.Beat(513)).frame
    long = encode_frame(bytes([0x03]) * MAX_BODY)
    return [
        ("one bit of the body is wrong", _changed(beat, 3, 0x04)),
        ("one bit of the check is wrong", _changed(beat, len(beat) - 2, 0x01)),
        ("the first bits of the check are wrong", _changed(beat, len(beat) - 4, 0x40)),
        ("a byte is missing", beat[:4] + beat[5:]),
        ("cut short", beat[:5] + beat[-1:]),
        ("a byte too long", long[:-4] + bytes([0x03]) + long[-4:]),
        ("a piece of COBS passes the end", _checked(bytes([0x09, 0x03, 0x01]))),
        ("shorter than its message", encode_frame(Vector(0xABCD, m.Beat(513)).body[:-1])),
        ("shorter than a header", encode_frame(bytes([0x03, 0x01]))),
        ("number 0 of a command", encode_frame(bytes([0x12, 0xCD, 0xAB, 0, 0, 0, 0]))),
        ("a valence out of its range", _out_of_range()),
        ("a number that no message has", encode_frame(bytes([0x77, 0xCD, 0xAB, 1, 2, 3]))),
        ("what only a robot may say", Vector(0xABCD, m.Ack(4, m.RESULT_TAKEN)).frame),
        (
            "a MOVE of 44 bytes",
            encode_frame(Vector(0xABCD, m.Move(5, 0.0, 0, 1, _LEVEL)).body[:-1]),
        ),
    ]


def vectors_file() -> str:
    """Return all vectors as JSON."""
    document = {
        "protocol": "cubeling",
        "version": VERSION,
        "about": "bytes in hexadecimal; `frame` with its edges; `fields` in the units of "
        "PROTOCOL.md; `version` is the one in which the message is sent",
        "frames": [_entry(vector) for vector in VECTORS],
        "skipped by a robot": [{"why": why, "bytes": data.hex(" ")} for why, data in broken()],
    }
    return json.dumps(document, indent=1) + "\n"


def _entry(vector: Vector) -> dict[str, object]:
    return {
        "message": spec_of(type(vector.content)).name,
        "version": vector.version,
        "session": vector.session,
        "fields": asdict(vector.content),  # type: ignore[call-overload] # a message is a dataclass
        "body": vector.body.hex(" "),
        "frame": vector.frame.hex(" "),
    }


def _changed(frame: bytes, at: int, bits: int) -> bytes:
    return frame[:at] + bytes([frame[at] ^ bits]) + frame[at + 1 :]


def _checked(encoded: bytes) -> bytes:
    """Return a frame of bytes that COBS never produces, with a valid check."""
    return b"\0" + encoded + check_bytes(encoded) + b"\0"


def _out_of_range() -> bytes:
    body = bytearray(Vector(0xABCD, m.Express(1, 1.0, 0.0)).body)
    body[7:9] = (10001).to_bytes(2, "little")
    return encode_frame(bytes(body))
