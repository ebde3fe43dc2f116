"""Lines out of what a robot says, whatever it says."""


class LineReader:
    """Cuts a stream into lines, and holds no more of it than a line.

    Parameters
    ----------
    longest
        Longest line that matters [bytes]; a longer one is thrown away.
    """

    def __init__(self, longest: int) -> None:
        self.cut = 0
        """Lines that were longer, and so were thrown away."""
        self._longest = longest
        self._begun = bytearray()
        self._too_long = False

    @property
    def begun(self) -> str:
        """The beginning of a line that has not ended yet: a question may stand there."""
        return self._begun.decode("latin-1")

    def feed(self, data: bytes) -> list[str]:
        r"""Take bytes; return the lines that ended in them, without their ends.

        >>> LineReader(200).feed(b"Bittle X\r\nB10_241013\r\n?\r\nRea")
        ['Bittle X', 'B10_241013', '?']
        """
        *ended, rest = data.split(b"\n")
        lines = []
        for piece in ended:
            self._add(piece)
            if not self._too_long:
                lines.append(self._begun.decode("latin-1").strip("\r\0 \t"))
            self.clear()
        self._add(rest)
        return lines

    def clear(self) -> None:
        """Forget the line that has begun."""
        self._begun.clear()
        self._too_long = False

    def _add(self, piece: bytes) -> None:
        if len(self._begun) + len(piece) > self._longest and not self._too_long:
            self._too_long = True
            self.cut += 1
        if self._too_long:
            self._begun.clear()
        else:
            self._begun += piece
