"""What one client of a block server has sent: its token, and then documents that wait."""

from collections import deque
from collections.abc import Iterator

from cubeling.app.admission import ClientLimits, Token
from cubeling.app.behaving.splitting import DocumentSplitter, StreamBroken

MAX_LINE_BYTES = 200
"""Longest first line of a client."""


class ServedClient:
    """Takes the bytes of a client as far as its limits allow. It has no socket and no clock.

    Parameters
    ----------
    token
        What the client has to tell in its first line.
    limits
        What it may use.
    now
        The time [s].
    """

    def __init__(self, token: Token, limits: ClientLimits, now: float) -> None:
        self.waiting: deque[bytes] = deque()
        """Documents that wait for their turn."""
        self.admitted = False
        """Whether it has told the token."""
        self._token, self._limits = token, limits
        self._line = b""
        self._splitter = DocumentSplitter()
        self._documents: Iterator[bytes] = iter(())
        self._came = self._began = now
        self.heard = now
        """When something came from it last [s]."""

    @property
    def full(self) -> bool:
        """Whether nothing more is to be read before its next turn."""
        size = sum(map(len, self.waiting))
        return len(self.waiting) >= self._limits.documents or size >= self._limits.bytes

    def receive(self, received: bytes, now: float) -> None:
        """Take what has come, at a time [s].

        Raises
        ------
        StreamBroken
            If the token is wrong, or it is no XML.
        """
        self.heard = now
        if not self.admitted:
            received = self._admit(received)
        if not self._splitter.open:
            self._began = now
        self._documents = self._splitter.feed(received)
        self.read(now)

    def read(self, now: float) -> None:
        """Find more documents in what has come, until it is full.

        Raises
        ------
        StreamBroken
            If it is no XML.
        """
        while not self.full:
            document = next(self._documents, None)
            if document is None:
                return
            self.waiting.append(document)
            self._began = now

    def overdue(self, now: float) -> str:
        """Return why it is to be disconnected at a time [s]; "" if it is not."""
        limits = self._limits
        if not self.admitted:
            late = now > self._came + limits.admission_s
            return f"no token within {limits.admission_s:g} s" if late else ""
        if self.full:
            self.heard = self._began = now  # it is we who do not read
        if self._splitter.open and now > self._began + limits.document_s:
            return f"a document that is not complete after {limits.document_s:g} s"
        idle = now > self.heard + limits.idle_s
        return f"nothing has come for {limits.idle_s:g} s" if idle else ""

    def _admit(self, received: bytes) -> bytes:
        """Read the first line as far as it is there, and return what follows it."""
        self._line += received
        line, end, rest = self._line.partition(b"\n")
        if not end and len(line) <= MAX_LINE_BYTES:
            return b""
        word, _, offered = line[:MAX_LINE_BYTES].decode("ascii", "replace").strip().partition(" ")
        if not end or word != "token" or not self._token.admits(offered.strip()):
            raise StreamBroken("the first line has to be: token, and the token of this program")
        self._line, self.admitted = b"", True
        return rest
