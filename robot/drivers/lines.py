"""Splits the bytes of a robot into lines."""


class LineReader:
    """Splits a stream into lines of at most `max_bytes`, and discards longer ones."""

    def __init__(self, max_bytes: int) -> None:
        self.too_long = 0
        """Number of lines that were discarded."""
        self._max_bytes = max_bytes
        self._partial = bytearray()
        self._discarding = False

    @property
    def partial(self) -> str:
        """The beginning of a line that has not ended yet: it may hold a question."""
        return self._partial.decode("latin-1")

    def feed(self, data: bytes) -> list[str]:
        r"""Process bytes; return the lines that ended in them, without their ends.

        >>> LineReader(200).feed(b"Bittle X\r\nB10_241013\r\n?\r\nRea")
        ['Bittle X', 'B10_241013', '?']
        """
        *ended, rest = data.split(b"\n")
        lines = []
        for piece in ended:
            self._append(piece)
            if not self._discarding:
                lines.append(self._partial.decode("latin-1").strip("\r\0 \t"))
            self.clear()
        self._append(rest)
        return lines

    def clear(self) -> None:
        """Forget the line that has not ended."""
        self._partial.clear()
        self._discarding = False

    def _append(self, piece: bytes) -> None:
        if len(self._partial) + len(piece) > self._max_bytes and not self._discarding:
            self._discarding = True
            self.too_long += 1
        if self._discarding:
            self._partial.clear()
        else:
            self._partial += piece
