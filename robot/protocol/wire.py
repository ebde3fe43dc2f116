"""Framing on a serial line: delimiters and a checksum.

On the wire a frame is::

    00 | COBS(body) | three check bytes | 00

COBS (Cheshire & Baker 1999) removes the zero bytes from the body, so a zero on the line is always a
delimiter. The leading delimiter costs one byte; thanks to it the next frame is received whatever
garbage came before. The check is CRC-16/CCITT-FALSE over the *encoded* bytes, so that its guarantee
holds for the bits on the line and not only for the decoded ones; it is spread over three bytes,
``1110hhhh 10mmmmmm 10llllll``, so that none of them is zero.
"""

from binascii import crc_hqx

MAX_BODY = 120
"""Longest body of a frame [bytes]; one COBS run, so that encoding adds exactly one byte."""

MAX_FRAME = MAX_BODY + 1 + 3
"""Longest frame between its delimiters [bytes]."""

_RUN_CODES = tuple(bytes([length + 1]) for length in range(MAX_BODY + 1))
"""The COBS code byte of a run of each length."""


class FrameError(ValueError):
    """Bytes between two delimiters that are no frame."""


def crc16(data: bytes) -> int:
    """CRC-16/CCITT-FALSE: polynomial 0x1021, start 0xFFFF, not reflected.

    It detects any one, two or three wrong bits in up to 32751 bits (Koopman & Chakravarty 2004);
    our longest frame has 984.

    >>> hex(crc16(b"123456789"))
    '0x29b1'
    """
    return crc_hqx(data, 0xFFFF)


def cobs_encode(body: bytes) -> bytes:
    """Encode at most `MAX_BODY` bytes without a zero byte.

    >>> cobs_encode(bytes([7, 0, 8, 9])).hex(" ")
    '02 07 03 08 09'
    """
    return b"".join([_RUN_CODES[len(run)] + run for run in body.split(b"\0")])


def cobs_decode(encoded: bytes) -> bytes:
    """Undo `cobs_encode`; raises FrameError unless the runs fill the bytes exactly."""
    if not encoded:
        raise FrameError("empty frame")
    body = bytearray(encoded)
    start, length = 0, len(encoded)
    while start < length:
        run = encoded[start]
        if not run:
            raise FrameError("a run of COBS is empty")
        body[start] = 0  # each run replaces a zero; the first replaces none
        start += run
    # Equal is right: the last run ends exactly with the bytes.
    if start > length:
        raise FrameError("a run of COBS passes the end of the frame")
    return bytes(body[1:])


def encode_frame(body: bytes) -> bytes:
    """Return the bytes on the wire of a body of 1 to `MAX_BODY` bytes, delimiters included."""
    if not 1 <= len(body) <= MAX_BODY:
        raise ValueError(f"a frame holds 1 to {MAX_BODY} bytes, not {len(body)}")
    encoded = cobs_encode(body)
    return b"\0" + encoded + check_bytes(encoded) + b"\0"


def decode_frame(frame: bytes) -> bytes:
    """Return the body of the bytes between two delimiters; raises FrameError if there is none."""
    # 5: one byte of body, one of COBS, three of the check.
    if not 5 <= len(frame) <= MAX_FRAME:
        raise FrameError("too short or too long for a frame")
    encoded = frame[:-3]
    # Before COBS is decoded: a frame with wrong bits need not be understood.
    if frame[-3:] != check_bytes(encoded):
        raise FrameError("the check does not match")
    return cobs_decode(encoded)


def check_bytes(encoded: bytes) -> bytes:
    """Return the three bytes that follow an encoded body."""
    crc = crc16(encoded)
    return bytes([0xE0 | crc >> 12, 0x80 | crc >> 6 & 0x3F, 0x80 | crc & 0x3F])


class FrameReader:
    """Finds the frames in a stream that may be cut anywhere and hold anything between them."""

    def __init__(self) -> None:
        self.frames = 0
        """Valid frames received."""
        self.errors = 0
        """Invalid stretches between two delimiters: noise, or frames with wrong bits."""
        self._pending = bytearray()

    @property
    def buffered(self) -> int:
        """Number of bytes that it keeps, at most `MAX_FRAME` + 1."""
        return len(self._pending)

    def feed(self, data: bytes) -> list[bytes]:
        """Process the next bytes of the stream; return the bodies of the frames they complete."""
        bodies = []
        *ended, rest = data.split(b"\0")
        for piece in ended:
            self._keep(piece)
            # Two zeros in a row, as between frames, are no empty frame.
            if self._pending:
                body = self._finish()
                if body is not None:
                    bodies.append(body)
        self._keep(rest)
        return bodies

    def _keep(self, piece: bytes) -> None:
        # One byte more than the longest frame is enough to know that this is none.
        self._pending += piece[: MAX_FRAME + 1 - len(self._pending)]

    def _finish(self) -> bytes | None:
        frame = bytes(self._pending)
        self._pending.clear()
        try:
            body = decode_frame(frame)
        except FrameError:
            self.errors += 1
            return None
        self.frames += 1
        return body
