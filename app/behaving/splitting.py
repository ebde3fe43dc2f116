"""Cutting a stream of bytes into XML documents, one after another."""

import re
from collections.abc import Iterator
from xml.parsers import expat

MAX_BYTES = 1 << 20
"""Size of a document that is taken."""

SEPARATORS = b" \t\r\n\xef\xbb\xbf"
"""Bytes between documents: white space, and the mark of UTF-8."""

LONG_MARKUP = {b"<!--": b"-->", b"<![CDATA[": b"]]>", b"<?": b"?>"}
"""What markup that is no tag begins and ends with."""

_SPACE = re.compile(rb"[%s]*" % SEPARATORS)

_IN_TAG = re.compile(rb"[\"'<>]")


class StreamBroken(Exception):  # noqa: N818 -- the state of a stream, not a bug
    """What comes is no XML; where the next document begins is not known. The message says why."""


class DocumentSplitter:
    """Finds where the documents of a stream end: with the closing tag of their root.

    >>> splitter = DocumentSplitter()
    >>> [*splitter.feed(b'<bml id="a"/> <bml id="b">')], [*splitter.feed(b"</bml>")]
    ([b'<bml id="a"/>'], [b'<bml id="b"></bml>'])
    """

    def __init__(self) -> None:
        self._markup = _Markup()
        self._restart()

    @property
    def open(self) -> bool:
        """Whether a document has begun and has not ended."""
        return bool(self._document or self._markup.rest)

    def feed(self, received: bytes) -> Iterator[bytes]:
        """Yield the documents that bytes complete.

        Raises
        ------
        StreamBroken
            If they are no XML, declare a DTD, or a document is too large.
        """
        self._markup.rest += received
        while piece := self._markup.take():
            self._take(piece)
            if self._ended:
                document = bytes(self._document)
                self._restart()
                yield document
        if not self._document:
            self._markup.skip_space()
            if bytes(self._markup.rest[:1]) not in (b"", b"<"):
                raise StreamBroken("not XML (a document begins with <)")
        self._check_size(len(self._markup.rest))

    def _take(self, piece: bytes) -> None:
        if not self._document:
            piece = piece.lstrip(SEPARATORS)
            if not piece.startswith(b"<"):
                raise StreamBroken("not XML (a document begins with <)")
        self._document += piece
        self._check_size()
        try:
            self._parser.Parse(piece, False)
        except expat.ExpatError as error:
            message = expat.errors.messages[error.code]
            raise StreamBroken(f"not XML ({message}, line {error.lineno})") from None
        except (LookupError, ValueError):
            raise StreamBroken("not XML (its encoding is not known)") from None

    def _check_size(self, more: int = 0) -> None:
        if len(self._document) + more > MAX_BYTES:
            raise StreamBroken(f"a document of more than {MAX_BYTES} bytes")

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


class _Markup:
    """Cuts bytes after each tag, comment, section and instruction.

    The parser gets nothing else, as it reads what is not complete from its start each time: a
    comment of a million ">" would take minutes.
    """

    def __init__(self) -> None:
        self.rest = bytearray()
        """What is not taken yet."""
        self._at = 0
        self._closing = b""

    def skip_space(self) -> None:
        """Throw away what may be between documents."""
        found = _SPACE.match(self.rest)
        size = 0 if found is None else found.end()
        del self.rest[:size]
        self._at = max(self._at - size, 0)

    def take(self) -> bytes:
        """Return what comes up to the end of the next markup; nothing if that is not there."""
        while True:
            found = self._look()
            if found < 0:
                return b""
            if found:
                piece = bytes(self.rest[:found])
                del self.rest[:found]
                self._at = 0
                return piece

    def _look(self) -> int:
        """Return where markup ends, 0 to look on, or −1 if more has to come."""
        if self._closing in (b"", b">"):
            return self._look_in_tag() if self._closing else self._look_for_start()
        found = self.rest.find(self._closing, self._at)
        if found < 0:
            self._at = max(self._at, len(self.rest) - len(self._closing) + 1)
            return -1
        self._at = found + len(self._closing)
        if len(self._closing) == 1:  # a quote, and the tag goes on
            self._closing = b">"
            return 0
        self._closing = b""
        return self._at

    def _look_for_start(self) -> int:
        start = self.rest.find(b"<", self._at)
        if start < 0:
            self._at = len(self.rest)
            return -1
        self._at = start
        head = bytes(self.rest[start : start + 9])
        for opening, closing in LONG_MARKUP.items():
            if head.startswith(opening):
                self._at, self._closing = start + len(opening), closing
                return 0
            if opening.startswith(head):
                return -1
        if head.startswith(b"<!"):
            raise StreamBroken("DTDs and entities are not read")
        self._at, self._closing = start + 1, b">"
        return 0

    def _look_in_tag(self) -> int:
        found = _IN_TAG.search(self.rest, self._at)
        if found is None:
            self._at = len(self.rest)
            return -1
        self._at = found.end()
        if found[0] == b"<":
            raise StreamBroken("not XML (a tag in a tag)")
        self._closing = b"" if found[0] == b">" else bytes(found[0])
        return self._at if found[0] == b">" else 0
