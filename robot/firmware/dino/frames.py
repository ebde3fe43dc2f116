"""Frames on the line: PROTOCOL.md, section 2. Nothing is allocated for a byte or a frame."""

from .messages import MAX_BODY, MAX_FRAME

OVERHEAD = 6
"""Bytes that a frame has more than its body: two edges, one of COBS, three of the check."""

_SHORTEST = 5  # one byte of body, one of COBS, three of the check


def _remainders() -> tuple[int, ...]:
    """Return what four bits leave in the register of the check."""
    table = []
    for bits in range(16):
        register = bits << 12
        for _ in range(4):
            register = register << 1 ^ (0x1021 if register & 0x8000 else 0)
        table.append(register & 0xFFFF)
    return tuple(table)


_TABLE = _remainders()


def crc16(data: bytes | bytearray, start: int, end: int, register: int = 0xFFFF) -> int:
    """Return the CRC-16/CCITT-FALSE of a stretch of bytes, begun with `register`."""
    for index in range(start, end):
        byte = data[index]
        register = (register << 4 & 0xFFFF) ^ _TABLE[register >> 12 ^ byte >> 4]
        register = (register << 4 & 0xFFFF) ^ _TABLE[register >> 12 ^ byte & 15]
    return register


def encode(body: bytearray, size: int, out: bytearray, at: int) -> int:
    """Write the frame of a body of `size` bytes into `out` from `at` on; return where it ends."""
    out[at] = 0
    first = code = at + 1
    at += 2
    for index in range(size):
        byte = body[index]
        if byte:
            out[at] = byte
        else:
            out[code] = at - code
            code = at
        at += 1
    out[code] = at - code
    crc = crc16(out, first, at)
    out[at] = 0xE0 | crc >> 12
    out[at + 1] = 0x80 | crc >> 6 & 0x3F
    out[at + 2] = 0x80 | crc & 0x3F
    out[at + 3] = 0
    return at + 4


def decode(frame: bytearray, size: int, body: bytearray) -> int:
    """Write the body of what stood between two edges into `body`; return its size, 0 if none."""
    if not _SHORTEST <= size <= MAX_FRAME:
        return 0
    end = size - 3
    crc = crc16(frame, 0, end)
    if (
        frame[end] != 0xE0 | crc >> 12
        or frame[end + 1] != 0x80 | crc >> 6 & 0x3F
        or frame[end + 2] != 0x80 | crc & 0x3F
    ):
        return 0
    at = length = 0
    while at < end:
        stop = at + frame[at]
        if stop > end:
            return 0  # a run of COBS passes the end
        for index in range(at + 1, stop):
            body[length] = frame[index]
            length += 1
        at = stop
        if at < end:
            body[length] = 0
            length += 1
    return length


class FrameReader:
    """Finds the frames in a stream that may be cut anywhere and hold anything between them."""

    def __init__(self) -> None:
        self.body = bytearray(MAX_BODY + 1)
        """The body of the last frame, until the next one."""
        self.errors = 0
        """Stretches between two edges that were no frame."""
        self._frame = bytearray(MAX_FRAME + 1)
        self._count = 0

    def feed(self, byte: int) -> int:
        """Take the next byte; return the size of the body that it completes, 0 if it does not."""
        count = self._count
        if byte:
            # One byte more than a frame can have is enough to know that it is none.
            if count <= MAX_FRAME:
                self._frame[count] = byte
                self._count = count + 1
            return 0
        self._count = 0
        if not count:
            return 0
        size = decode(self._frame, count, self.body)
        if not size:
            self.errors += 1
        return size


class Outbox:
    """Frames that wait for the line. What finds no room is lost, as on a line it may be.

    Parameters
    ----------
    size
        Bytes that may wait.
    """

    def __init__(self, size: int = 512) -> None:
        self.data = bytearray(size)
        """What waits, from `start` to `end`."""
        self.start = 0
        """The first byte that waits."""
        self.end = 0
        """One past the last."""
        self.lost = 0
        """Frames that found no room."""

    def put(self, body: bytearray, size: int) -> None:
        """Add the frame of a body."""
        if self.end + size + OVERHEAD > len(self.data):
            self.lost += 1
            return
        self.end = encode(body, size, self.data, self.end)

    def sent(self, count: int) -> None:
        """Forget the first `count` bytes: the line has taken them."""
        self.start += count
        if self.start >= self.end:
            self.start = self.end = 0
