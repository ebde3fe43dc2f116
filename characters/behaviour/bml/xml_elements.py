"""Read XML without DTD and entities, of bounded size."""

from dataclasses import dataclass, field
from xml.parsers import expat

from cubeling.characters.behaviour.bml.document import BML
from cubeling.characters.errors import CharacterError

MAX_BYTES = 1 << 20
"""Size of a document that is read."""

MAX_DEPTH = 32
"""Elements within elements that are read."""

MAX_ELEMENTS = 5000
"""Elements of a document that are read."""


@dataclass
class OpenElement:
    """An element, whose end may not have been read."""

    tag: str
    """Its name, without namespace."""

    namespace: str
    """Its namespace; that of BML if it has none."""

    attributes: dict[str, str]
    """Its attributes; those of a namespace are named "{namespace}name"."""

    line: int
    """Line of the document."""

    parts: list["str | OpenElement"] = field(default_factory=list)
    """Characters and elements inside, in their order."""

    @property
    def children(self) -> list["OpenElement"]:
        """The elements inside, in their order, without the text between them."""
        return [part for part in self.parts if isinstance(part, OpenElement)]

    @property
    def text(self) -> str:
        """All characters inside, those of its children too."""
        return "".join(part if isinstance(part, str) else part.text for part in self.parts)


def read_xml(document: str | bytes) -> OpenElement:
    """Return the root element of a document.

    Raises
    ------
    CharacterError
        If it is not well-formed, too large or too deep, or declares a DTD.
    """
    if len(document) > MAX_BYTES:
        raise CharacterError(f"BML: more than {MAX_BYTES} bytes; send shorter documents")
    parser = expat.ParserCreate(namespace_separator="}")
    builder = _Builder(parser)
    try:
        parser.Parse(document, True)
    except expat.ExpatError as error:
        message = expat.errors.messages[error.code]
        raise CharacterError(f"BML, line {error.lineno}: not XML ({message})") from None
    except (UnicodeEncodeError, LookupError, ValueError):
        raise CharacterError("BML: not XML (its encoding is not known)") from None
    return builder.roots[0]


class _Builder:
    """Builds elements from the events of a parser."""

    def __init__(self, parser: expat.XMLParserType) -> None:
        self.roots: list[OpenElement] = []
        self._open: list[OpenElement] = []
        self._count = 0
        self._parser = parser
        parser.buffer_text = True
        parser.StartElementHandler = self._start
        parser.EndElementHandler = lambda tag: self._open.pop()
        parser.CharacterDataHandler = lambda text: self._open[-1].parts.append(text)
        parser.StartDoctypeDeclHandler = lambda *_: self._refuse("DTDs and entities are not read")

    def _start(self, name: str, attributes: dict[str, str]) -> None:
        namespace, _, tag = name.rpartition("}")
        named = {f"{{{key}" if "}" in key else key: value for key, value in attributes.items()}
        element = OpenElement(tag, namespace or BML, named, self._parser.CurrentLineNumber)
        self._count += 1
        if self._count > MAX_ELEMENTS:
            self._refuse(f"more than {MAX_ELEMENTS} elements")
        if len(self._open) >= MAX_DEPTH:
            self._refuse(f"more than {MAX_DEPTH} nested elements")
        (self._open[-1].parts if self._open else self.roots).append(element)
        self._open.append(element)

    def _refuse(self, why: str) -> None:
        raise CharacterError(f"BML, line {self._parser.CurrentLineNumber}: {why}")
