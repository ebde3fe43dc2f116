"""Checks of section 2: where a frame begins and ends, and whether it arrived whole."""

import numpy as np

from robot.conformance.check import Chapter
from robot.conformance.probe import Probe
from robot.conformance.verdicts import UnmetError
from robot.protocol import messages as m
from robot.protocol.schema import pack
from robot.protocol.wire import MAX_BODY, crc16, encode_frame

FRAMES = Chapter("Frames", 2)

PIECE_EVERY = 0.003
"""Time between two bytes of a frame that comes in pieces [s]."""

_RANDOM = np.random.default_rng(2).integers(0, 256, 4096, np.uint8).tobytes()
_NOISE = {
    "one byte": b"\x55",
    "an edge too many": b"\0\0\0\0",
    "text": b"rst:0x1 (POWERON_RESET)\r\n> ",
    "200 bytes without an edge": b"\x7f" * 200,
    "250 bytes of noise": _RANDOM[:250],
    "noise that ends with an edge": _RANDOM[300:340].replace(b"\0", b"\1") + b"\0",
    "bytes above 127": bytes(range(128, 256)),
}


@FRAMES.must
def garbage_before_a_frame(robot: Probe) -> None:
    """After any garbage, the next whole frame is received."""
    robot.fresh()
    for what, noise in _NOISE.items():
        robot.write(noise)
        robot.beat(what)


@FRAMES.must
def half_a_frame_before_a_frame(robot: Probe) -> None:
    """A frame that breaks off anywhere costs no other; the next one's edge in front ends it."""
    robot.fresh()
    half = robot.frame(m.Beat(robot.next_count()))
    for length in range(1, len(half)):
        robot.write(half[:length])
        robot.beat(f"the first {length} bytes of a frame")
        robot.write(half[length:])
        robot.beat(f"a frame without its first {length} bytes")


@FRAMES.must
def frame_in_pieces(robot: Probe) -> None:
    """A frame may come byte by byte, with time between them."""
    robot.fresh()
    count = robot.next_count()
    for byte in robot.frame(m.Beat(count)):
        robot.write(bytes([byte]))
        robot.hear(PIECE_EVERY)
    robot.reaction(after="a frame byte by byte")
    states = [state.beat for _, state in robot.log.states[-20:]]
    if count not in states:
        raise UnmetError(f"STATE(beat={count}) after that BEAT byte by byte", f"{states[-4:]}")


@FRAMES.must
def frames_in_one_go(robot: Probe) -> None:
    """Frames may follow each other without a pause, with two edges between them or with one."""
    robot.fresh()
    for seam, what in ((b"\0\0", "two edges"), (b"\0", "one edge"), (b"\0" * 9, "nine edges")):
        counts = [robot.next_count() for _ in range(4)]
        frames = [robot.frame(m.Beat(count)).strip(b"\0") for count in counts]
        robot.write(b"\0" + seam.join(frames) + b"\0")
        for count in counts:
            robot.expect(m.State, f"four BEATs with {what} between them", beat=count)


@FRAMES.must
def wrong_bit_dropped(robot: Probe) -> None:
    """A frame with a wrong bit in its body or in the 16 bits of its check is dropped silently."""
    robot.fresh()
    frame = robot.frame(m.Express(0x01010101, 0.5, 0.5)).strip(b"\0")
    for place in range(0, 8 * (len(frame) - 3), 5):
        _drops(robot, frame, place, f"an EXPRESS whose bit {place} is wrong")
    for bit in (0, 3, 8, 13, 16, 21):
        place = 8 * (len(frame) - 3) + bit
        _drops(robot, frame, place, f"an EXPRESS with a wrong bit {bit} in its check")


@FRAMES.must
def wrong_mark_dropped(robot: Probe) -> None:
    """A frame whose check does not begin with 1110, 10 and 10 is dropped silently."""
    robot.fresh()
    frame = robot.frame(m.Express(0x01010101, 0.5, 0.5)).strip(b"\0")
    for bit in (4, 5, 6, 7, 14, 15, 22, 23):
        place = 8 * (len(frame) - 3) + bit
        _drops(robot, frame, place, f"an EXPRESS with a wrong bit {bit} among the marks")


@FRAMES.must
def wrong_cobs_dropped(robot: Probe) -> None:
    """A frame whose check fits, but whose last run of COBS passes its end, is dropped silently."""
    robot.fresh()
    for beyond in (1, 2, 100):
        count = robot.next_count()
        encoded = bytearray(pack(m.Beat(count), robot.session))
        encoded.insert(0, len(encoded) + 1 + beyond)
        robot.unanswered(_checked(bytes(encoded)), f"a run of COBS {beyond} bytes too long")
        _unseen(robot, count, "a frame whose COBS is wrong")


@FRAMES.must
def longest_frame_received(robot: Probe) -> None:
    """A frame may be 124 bytes long between its edges."""
    robot.fresh()
    count = robot.next_count()
    body = pack(m.Beat(count), robot.session)
    robot.write(encode_frame(body + b"\x11" * (MAX_BODY - len(body))))
    robot.expect(m.State, "a BEAT in the longest frame", beat=count)


@FRAMES.must
def longer_frame_dropped(robot: Probe) -> None:
    """A frame of more than 124 bytes between its edges is dropped silently."""
    robot.fresh()
    for length in (MAX_BODY + 1, MAX_BODY + 2, 200):
        count = robot.next_count()
        body = pack(m.Beat(count), robot.session)
        body += b"\x11" * (length - len(body))
        robot.unanswered(_checked(bytes([len(body) + 1]) + body), f"a body of {length} bytes")
        _unseen(robot, count, f"a BEAT of {length} bytes")


@FRAMES.must
def flood_survived(robot: Probe) -> None:
    """After 8 kB of noise at full speed, with and without edges, the robot answers a greeting."""
    robot.fresh()
    robot.pour(_RANDOM)
    robot.pour(_RANDOM.replace(b"\0", b"\1"))
    robot.next_session()
    robot.greet()
    robot.beat("8 kB of noise and a greeting")


def _drops(robot: Probe, frame: bytes, place: int, what: str) -> None:
    """See that a frame is dropped whose bit at `place` is wrong; the highest bit of a byte is 7."""
    damaged = bytearray(frame)
    damaged[place // 8] ^= 1 << place % 8
    if 0 in damaged:
        return  # that bit would cut the frame in two
    robot.unanswered(b"\0" + bytes(damaged) + b"\0", what)
    taken = robot.beat(what).taken
    if taken:
        raise UnmetError(f"STATE(taken=0) after {what}", f"taken={taken}")


def _unseen(robot: Probe, count: int, what: str) -> None:
    """See that no STATE has answered a BEAT that should have been dropped."""
    robot.hear(0)
    if any(state.beat == count for _, state in robot.log.states[-20:]):
        raise UnmetError(f"no answer to {what}", f"STATE(beat={count})")


def _checked(encoded: bytes) -> bytes:
    """Make a frame with a check that fits of bytes that need not be COBS."""
    crc = crc16(encoded)
    check = bytes([0xE0 | crc >> 12, 0x80 | crc >> 6 & 0x3F, 0x80 | crc & 0x3F])
    return b"\0" + encoded + check + b"\0"
