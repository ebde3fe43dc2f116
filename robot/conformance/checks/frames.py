"""Checks of section 2: where a frame begins and ends, and whether it arrived undamaged."""

import numpy as np

from cubeling.robot.conformance.check import CheckGroup
from cubeling.robot.conformance.errors import CheckFailed
from cubeling.robot.conformance.probe import Probe
from cubeling.robot.protocol import messages as m
from cubeling.robot.protocol.schema import pack
from cubeling.robot.protocol.wire import MAX_BODY, crc16, encode_frame

FRAMES = CheckGroup("Frames", 2)

NOISE_BYTES = 256
"""Bytes of noise in one write; a line of 115200 baud takes 22 ms for them."""

NOISE_EVERY_S = 0.025
"""Time between two such writes [s]."""

BYTE_EVERY_S = 0.003
"""Time between two bytes of a frame that arrives in pieces [s]."""

PAUSE_S = 0.15
"""Pause in the middle of a frame, and before its last edge [s]."""

BURST = 30
"""BEATs in one write, of which the answers are more than a small robot can keep."""

BURST_ANSWERED_S = 0.25
"""Time for the answers to a burst [s]; a line of 115200 baud takes 170 ms for them."""

JUNK_LENGTHS = (1, 60, *range(119, 132), *range(250, 258), 510, 512)
"""Bytes before a frame without an edge: about what buffers hold."""

FEW_LENGTHS = (1, 60, 125)
"""Those of which as many come after a frame."""

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
def garbage_before_a_frame(probe: Probe) -> None:
    """After any garbage, the next whole frame is received."""
    probe.open_session()
    for what, noise in _NOISE.items():
        probe.write(noise)
        probe.beat(what)


@FRAMES.must
def half_a_frame_before_a_frame(probe: Probe) -> None:
    """An incomplete frame costs no other frame: the first edge of the next one ends it."""
    probe.open_session()
    half = probe.frame(m.Beat(probe.next_beat()))
    for length in range(1, len(half)):
        probe.write(half[:length])
        probe.beat(f"a frame cut off after byte {length}")
        probe.write(half[length:])
        probe.beat(f"the rest of a frame after byte {length}")


@FRAMES.must
def frame_in_pieces(probe: Probe) -> None:
    """A frame may arrive byte by byte, with pauses between them; it ends with its edge."""
    probe.open_session()
    for cut in (5, -1):
        count = probe.next_beat()
        frame = probe.frame(m.Beat(count))
        probe.write(frame[:cut])
        probe.receive(PAUSE_S)
        _expect_not_answered(probe, count, "a BEAT without its last edge")
        probe.write(frame[cut:])
        after = f"a BEAT with a pause of {1000 * PAUSE_S:.0f} ms in it"
        probe.expect(m.State, after, beat=count)
    count = probe.next_beat()
    for byte in probe.frame(m.Beat(count)):
        probe.write(bytes([byte]))
        probe.receive(BYTE_EVERY_S)
    probe.replies_to(after="a frame byte by byte")
    beats = _last_beats(probe)
    if count not in beats:
        raise CheckFailed(f"STATE(beat={count}) after that BEAT byte by byte", f"{beats[-4:]}")


@FRAMES.must
def frames_in_one_go(probe: Probe) -> None:
    """Frames may follow each other without a pause, with two edges between them or with one."""
    probe.open_session()
    for seam, what in ((b"\0\0", "two edges"), (b"\0", "one edge"), (b"\0" * 9, "nine edges")):
        counts = [probe.next_beat() for _ in range(4)]
        frames = [probe.frame(m.Beat(count)).strip(b"\0") for count in counts]
        probe.write(b"\0" + seam.join(frames) + b"\0")
        for count in counts:
            probe.expect(m.State, f"four BEATs with {what} between them", beat=count)


@FRAMES.must
def wrong_bit_dropped(probe: Probe) -> None:
    """A frame with a wrong bit in its body or in the 16 bits of its check is dropped silently."""
    probe.open_session()
    frame = probe.frame(m.Express(0x01010101, 0.5, 0.5)).strip(b"\0")
    for place in range(0, 8 * (len(frame) - 3), 5):
        _expect_dropped(probe, frame, place, f"an EXPRESS whose bit {place} is wrong")
    for bit in (0, 3, 8, 13, 16, 21):
        place = 8 * (len(frame) - 3) + bit
        _expect_dropped(probe, frame, place, f"an EXPRESS with a wrong bit {bit} in its check")


@FRAMES.must
def wrong_mark_dropped(probe: Probe) -> None:
    """A frame whose check does not begin with 1110, 10 and 10 is dropped silently."""
    probe.open_session()
    frame = probe.frame(m.Express(0x01010101, 0.5, 0.5)).strip(b"\0")
    for bit in (4, 5, 6, 7, 14, 15, 22, 23):
        place = 8 * (len(frame) - 3) + bit
        _expect_dropped(probe, frame, place, f"an EXPRESS with a wrong bit {bit} in the marks")


@FRAMES.must
def wrong_cobs_dropped(probe: Probe) -> None:
    """A frame whose check is right, but whose last COBS run passes its end, is dropped silently."""
    probe.open_session()
    for excess in (1, 2, 100):
        count = probe.next_beat()
        encoded = bytearray(pack(m.Beat(count), probe.session))
        encoded.insert(0, len(encoded) + 1 + excess)
        probe.expect_no_reply(_with_check(bytes(encoded)), f"a COBS run too long by {excess}")
        _expect_not_answered(probe, count, "a frame with wrong COBS")


@FRAMES.must
def frames_found_only_between_edges(probe: Probe) -> None:
    """Bytes before or after a frame, without an edge between them, make it invalid.

    So it is after 125 bytes too: all bytes up to the next edge are dropped.
    """
    probe.open_session()
    for length in JUNK_LENGTHS:
        for behind in (False, True) if length in FEW_LENGTHS else (False,):
            count = probe.next_beat()
            frame = probe.frame(m.Beat(count)).strip(b"\0")
            junk = b"\x55" * length
            what = f"a BEAT {'before' if behind else 'after'} {length} bytes without an edge"
            data = frame + junk if behind else junk + frame
            probe.expect_no_reply(b"\0" + data + b"\0", what)
            _expect_not_answered(probe, count, what)


@FRAMES.must
def longest_frame_received(probe: Probe) -> None:
    """A frame may be 124 bytes long between its edges."""
    probe.open_session()
    count = probe.next_beat()
    body = pack(m.Beat(count), probe.session)
    probe.write(encode_frame(body + b"\x11" * (MAX_BODY - len(body))))
    probe.expect(m.State, "a BEAT in the longest frame", beat=count)


@FRAMES.must
def longer_frame_dropped(probe: Probe) -> None:
    """A frame of more than 124 bytes between its edges is dropped silently."""
    probe.open_session()
    for length in (MAX_BODY + 1, MAX_BODY + 2, 200):
        count = probe.next_beat()
        body = pack(m.Beat(count), probe.session)
        body += b"\x11" * (length - len(body))
        frame = _with_check(bytes([len(body) + 1]) + body)
        probe.expect_no_reply(frame, f"a body of {length} bytes")
        _expect_not_answered(probe, count, f"a BEAT of {length} bytes")
    for more in (1, 2, 3, 100):
        count = probe.next_beat()
        body = pack(m.Beat(count), probe.session)
        longest = encode_frame(body + b"\x11" * (MAX_BODY - len(body)))
        what = f"a BEAT of {MAX_BODY} bytes with {more} bytes before its edge"
        probe.expect_no_reply(longest[:-1] + b"\x11" * more + b"\0", what)
        _expect_not_answered(probe, count, what)


@FRAMES.must_of(5)
def burst_survived(probe: Probe) -> str:
    """A robot that cannot send all answers drops frames, but keeps its session and goes on."""
    probe.open_session()
    before = len(probe.log.states)
    probe.send(*(m.Beat(probe.next_beat()) for _ in range(BURST)))
    probe.receive(BURST_ANSWERED_S)
    answers = len(probe.log.states) - before
    probe.beat(f"{BURST} BEATs in one write")
    return f"{answers} STATEs for {BURST} BEATs in one write"


@FRAMES.must
def flood_survived(probe: Probe) -> None:
    """After 8 kB of noise at full speed, with and without edges, the robot answers HELLO."""
    probe.open_session()
    noise = _RANDOM + _RANDOM.replace(b"\0", b"\1")
    for start in range(0, len(noise), NOISE_BYTES):
        probe.write(noise[start : start + NOISE_BYTES], keep=True)
        probe.receive(NOISE_EVERY_S)
    probe.next_session()
    probe.hello()
    probe.beat("8 kB of noise and HELLO")


def _expect_dropped(probe: Probe, frame: bytes, place: int, what: str) -> None:
    """Send a frame whose bit at `place` is inverted; bit 7 of a byte is its highest."""
    damaged = bytearray(frame)
    damaged[place // 8] ^= 1 << place % 8
    if 0 in damaged:
        return  # that bit would split the frame in two
    probe.expect_no_reply(b"\0" + bytes(damaged) + b"\0", what)
    probe.expect_taken(0, what)


def _expect_not_answered(probe: Probe, count: int, what: str) -> None:
    """Check that no STATE answered a BEAT that should have been dropped."""
    probe.receive(0)
    if count in _last_beats(probe):
        raise CheckFailed(f"no answer to {what}", f"STATE(beat={count})")


def _last_beats(probe: Probe) -> list[int]:
    return [state.beat for _, state in probe.log.states[-20:]]


def _with_check(encoded: bytes) -> bytes:
    """Return a frame with a right check, of bytes that need not be valid COBS."""
    crc = crc16(encoded)
    check = bytes([0xE0 | crc >> 12, 0x80 | crc >> 6 & 0x3F, 0x80 | crc & 0x3F])
    return b"\0" + encoded + check + b"\0"
