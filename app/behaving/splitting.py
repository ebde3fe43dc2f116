"""Cutting a stream of bytes into XML documents, one after another."""

from collections.abc import Iterator
from xml.parsers import expat

MAX_BYTES = 1 << 20
"""Size of a document that is taken."""

BETWEEN = b" \t\r\n\xef\xbb\xbf"
"""Bytes between documents: white space, and the mark of UTF-8."""


class StreamBroken(Exception):  # noqa: N818 -- the state of a stream, not a bug
    """What comes is no XML; where the next document begins is not known. The message says why."""


class DocumentSplitter:
    """Finds where the documents of a stream end: with the closing tag of their root.

    >>> splitter = DocumentSplitter()
    >>> [*splitter.feed(b'<bml id="a"/> <bml id="b">')], [*splitter.feed(b"</bml>")]
    ([b'<bml id="a"/>'], [b'<bml id="b"></bml>'])
    """

    def __init__(self) -> None:
        self._restart()

    @property
    def open(self) -> bool:
        """Whether a document has begun and has not ended."""
        return bool(self._document)

    def feed(self, received: bytes) -> Iterator[bytes]:
        """Yield the documents that bytes complete.

        Raises
        ------
        StreamBroken
            If they are no XML, declare a DTD, or a document is too large.
        """
        # A document can end only where a tag ends.
        pieces = received.split(b">")
        for number, piece in enumerate(pieces):
            last = number == len(pieces) - 1
            self._take(piece if last else piece + b">")
            if self._ended:
                document = bytes(self._document)
                self._restart()
                yield document

    def _take(self, piece: bytes) -> None:
        if not self._document:
            piece = piece.lstrip(BETWEEN)
        if not piece:
            return
        if not self._document and not piece.startswith(b"<"):
            raise StreamBroken("not XML (a document begins with <)")
        self._document += piece
        if len(self._document) > MAX_BYTES:
            raise StreamBroken(f"a document of more than {MAX_BYTES} bytes")
        try:
            self._parser.Parse(piece, False)
        except expat.ExpatError as error:
            message = expat.errors.messages[error.code]
            raise StreamBroken(f"not XML ({message}, line {error.lineno})") from None
        except (LookupError, ValueError):
            raise StreamBroken("not XML (its encoding is not known)") from None

    def _restart(self) -> None:
        self._document = bytearray()
        self._depth = 0
        self._ended = False
        self._parser = expat.ParserCreate()
        # A tag is reported when it is complete, not some bytes later (expat 2.6).
        if hasattr(self._parser, "SetReparseDeferralEnabled"):
            self._parser.SetReparseDeferralEnabled(False)
        self._parser.StartElementHandler = self._start
        self._parser.EndElementHandler = self._end
        self._parser.StartDoctypeDeclHandler = self._refuse

    def _start(self, _tag: str, _attributes: object) -> None:
        self._depth += 1

    def _end(self, _tag: str) -> None:
        self._depth -= 1
        self._ended = self._depth == 0

    def _refuse(self, *_: object) -> None:
        raise StreamBroken("DTDs and entities are not read")
