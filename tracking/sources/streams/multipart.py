"""A parser of multipart streams, fed with chunks of any size."""

MAX_PART_BYTES = 32 * 2**20
"""Larger parts are not images."""

MAX_PREAMBLE_BYTES = 64 * 1024
"""A boundary that the header does not tell begins within the first bytes."""


class MultipartError(Exception):
    """The stream is not multipart; the message says why."""


class MultipartParser:
    r"""Splits a `multipart/x-mixed-replace` stream into its parts (RFC 2046, section 5.1).

    Accepts what cameras send against the standard: boundaries that include their dashes in the
    header, parts with and without Content-Length, lines that end with LF alone. A boundary that the
    header does not tell, "", is that of the first line that begins with dashes.

    >>> parser = MultipartParser("frame")
    >>> parser.feed(b"--frame\r\nContent-Length: 2\r\n\r\nab\r\n--fra")
    [b'ab']
    >>> parser.feed(b"me\r\n\r\ncde\r\n--frame--")
    [b'cde']
    >>> parser.ended
    True
    """

    def __init__(self, boundary: str) -> None:
        core = boundary.lstrip("-") or boundary
        self._delimiter = b"--" + core.encode("latin-1") if core else b""
        self._buffer = bytearray()
        self._searched = 0
        self._in_part = False
        self.ended = False
        """Whether the closing boundary has been received."""

    def feed(self, data: bytes) -> list[bytes]:
        """Add the next bytes; return the bodies of the parts that they complete.

        Raises
        ------
        MultipartError
            A part is larger than an image can be, or there are no parts.
        """
        self._buffer += data
        bodies = []
        while not self.ended:
            if not self._in_part and not self._enter_part():
                break
            body = self._take_body()
            if body is None:
                break
            bodies.append(body)
            self._in_part = False
        if len(self._buffer) > MAX_PART_BYTES:
            raise MultipartError("sends parts of more than 32 MB")
        return bodies

    def _enter_part(self) -> bool:
        """Drop everything up to the next delimiter; return whether it has been received."""
        if not self._delimiter:
            self._delimiter = self._first_line_with_dashes()
        start = self._find_delimiter()
        if not self._delimiter or start < 0:
            return False
        after = start + len(self._delimiter)
        if len(self._buffer) < after + 2:
            return False
        if self._buffer[after : after + 2] == b"--":
            self.ended = True
            return False
        del self._buffer[:after]
        self._searched = 0
        self._in_part = True
        return True

    def _take_body(self) -> bytes | None:
        header_end, body_start = _blank_line(self._buffer)
        if body_start < 0:
            return None
        length = _content_length(bytes(self._buffer[:header_end]))
        if length is not None:
            end = body_start + length
            if len(self._buffer) < end:
                return None
            body = bytes(self._buffer[body_start:end])
        else:
            self._searched = max(self._searched, body_start)
            end = self._find_delimiter()
            if end < 0:
                return None
            body = _without_line_end(bytes(self._buffer[body_start:end]))
        del self._buffer[:end]
        self._searched = 0
        return body

    def _first_line_with_dashes(self) -> bytes:
        """Return the first whole line that begins with two dashes; b"" while there is none."""
        lines = bytes(self._buffer[:MAX_PREAMBLE_BYTES]).split(b"\n")
        dashed = (line.rstrip(b"\r") for line in lines[:-1] if line.startswith(b"--"))
        found = next(dashed, b"")
        if not found and len(self._buffer) >= MAX_PREAMBLE_BYTES:
            raise MultipartError("is not a stream of JPEG images: nothing separates its parts")
        return found

    def _find_delimiter(self) -> int:
        found = self._buffer.find(self._delimiter, self._searched)
        if found < 0:
            self._searched = max(self._searched, len(self._buffer) - len(self._delimiter) + 1)
        return found


def _blank_line(buffer: bytearray) -> tuple[int, int]:
    """Return where a part's header ends and its body starts; −1 if not received yet."""
    ends = [(buffer.find(mark), len(mark)) for mark in (b"\r\n\r\n", b"\n\n")]
    found = [(at, at + size) for at, size in ends if at >= 0]
    return min(found, default=(-1, -1))


def _content_length(header: bytes) -> int | None:
    for line in header.splitlines():
        name, _, value = line.partition(b":")
        if name.strip().lower() == b"content-length" and value.strip().isdigit():
            return int(value)
    return None


def _without_line_end(body: bytes) -> bytes:
    """Drop the line end that belongs to the delimiter, and extra dashes before it."""
    body = body.rstrip(b"-")
    return body[:-2] if body.endswith(b"\r\n") else body.removesuffix(b"\n")
