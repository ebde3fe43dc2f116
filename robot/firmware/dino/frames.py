"""Framing: PROTOCOL.md, section 2. No memory is allocated per byte or frame."""

from .messages import MAX_BODY, MAX_FRAME

OVERHEAD_BYTES = 6
"""Bytes of a frame besides its body: two edges, one of COBS, three of the check."""

_MIN_FRAME = 5  # one byte of body, one of COBS, three of the check


def _crc_table() -> tuple[int, ...]:
    """Return the CRC of every 4-bit value."""
    table = []
    for bits in range(16):
        register = bits << 12
        for _ in range(4):
            register = register << 1 ^ (0x1021 if register & 0x8000 else 0)
        table.append(register & 0xFFFF)
    return tuple(table)


_CRC_TABLE = _crc_table()


def crc16(data: bytes | bytearray, start: int, end: int, register: int = 0xFFFF) -> int:
    """Return the CRC-16/CCITT-FALSE of `data[start:end]`, continued from `register`."""
    for index in range(start, end):
        byte = data[index]
        # The high half of the byte first, as CCITT-FALSE is not reflected.
        register = (register << 4 & 0xFFFF) ^ _CRC_TABLE[register >> 12 ^ byte >> 4]
        register = (register << 4 & 0xFFFF) ^ _CRC_TABLE[register >> 12 ^ byte & 15]
    return register


def encode(body: bytearray, size: int, out: bytearray, at: int) -> int:
    """Write the frame of a body of `size` bytes into `out` from `at` on; return its end."""
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
    # Over the encoded bytes, from the COBS code on: the guarantee holds for the bits on the line.
    crc = crc16(out, first, at)
    # 4 + 6 + 6 bits with marks above them: none of the three bytes can be zero.
    out[at] = 0xE0 | crc >> 12
    out[at + 1] = 0x80 | crc >> 6 & 0x3F
    out[at + 2] = 0x80 | crc & 0x3F
    out[at + 3] = 0
    return at + 4


def decode(frame: bytearray, size: int, body: bytearray) -> int:
    """Decode the bytes between two edges into `body`; return its size, 0 if not valid."""
    if not _MIN_FRAME <= size <= MAX_FRAME:
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


class FrameDecoder:
    """Finds the frames in a byte stream that may contain anything between them."""

    def __init__(self) -> None:
        self.body = bytearray(MAX_BODY + 1)
        """The body of the last frame, until the next one."""
        self._frame = bytearray(MAX_FRAME + 1)
        self._count = 0

    def feed(self, byte: int) -> int:
        """Process the next byte; return the size of the body that it completes, else 0."""
        count = self._count
        if byte:
            # One byte more than the longest frame is enough to know that it is not valid.
            if count <= MAX_FRAME:
                self._frame[count] = byte
                self._count = count + 1
            return 0
        self._count = 0
        if not count:
            return 0
        return decode(self._frame, count, self.body)


class TransmitBuffer:
    """Frames to be sent. When it is full, new frames are dropped, as a line may lose them."""

    def __init__(self, size: int = 512) -> None:
        self.data = bytearray(size)
        """The bytes to be sent are those from `start` to `end`."""
        self.start = 0
        """Begin of the bytes to be sent."""
        self.end = 0
        """End of the bytes to be sent."""
        self.dropped = 0
        """Number of dropped frames."""

    def put(self, body: bytearray, size: int) -> None:
        """Append the frame of a body."""
        if self.end + size + OVERHEAD_BYTES > len(self.data):
            self.dropped += 1
            return
        self.end = encode(body, size, self.data, self.end)

    def drop(self, count: int) -> None:
        """Remove the first `count` bytes, which were sent."""
        self.start += count
        if self.start >= self.end:
            self.start = self.end = 0
