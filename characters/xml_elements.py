"""Read XML without DTD and entities, of bounded size, in time that is linear in it."""

from collections.abc import Callable
from dataclasses import dataclass, field
from xml.parsers import expat

from cubeling.characters.errors import CharacterError

MAX_VALUE_CHARS = 2000
"""Longest attribute. Values come back in messages and feedback, and readers need time for each."""

MAX_NAME_CHARS = 200
"""Longest name of an element or an attribute, with its namespace."""

MAX_ATTRIBUTES = 100
"""Attributes of an element; nothing that is read has more than twenty."""


@dataclass
class XmlElement:
    """An element, whose end may not have been read."""

    tag: str
    """Its name, without namespace."""

    namespace: str
    """Its namespace; "" if it has none."""

    attributes: dict[str, str]
    """Its attributes; those of a namespace are named "{namespace}name"."""

    line: int
    """Line of the document."""

    parts: list["str | XmlElement"] = field(default_factory=list)
    """Characters and elements inside, in their order."""

    @property
    def children(self) -> list["XmlElement"]:
        """The elements inside, in their order, without the text between them."""
        return [part for part in self.parts if isinstance(part, XmlElement)]

    @property
    def text(self) -> str:
        """All characters inside, those of its children too."""
        return "".join(part if isinstance(part, str) else part.text for part in self.parts)


@dataclass(frozen=True)
class XmlLimits:
    """How large a document may be."""

    bytes: int
    """Most bytes of a document, or characters of a text."""

    elements: int
    """Most elements of a document: each becomes an object of Python."""

    depth: int
    """Most elements that are open at one time: readers and texts recurse so deep."""


def read_xml(text: str | bytes, limits: XmlLimits, place: Callable[[int], str]) -> XmlElement:
    """Return the root element of a document.

    Parameters
    ----------
    text
        The document.
    limits
        How large it may be.
    place
        Returns how messages name a line of it.

    Raises
    ------
    CharacterError
        If it is not well-formed, too large or too deep, or declares a DTD.
    """
    if len(text) > limits.bytes:
        raise CharacterError(f"{place(1)}: more than {limits.bytes} bytes; write shorter documents")
    parser = expat.ParserCreate(namespace_separator="}")
    builder = _Builder(parser, limits, place)
    try:
        parser.Parse(text, True)
    except expat.ExpatError as error:
        message = expat.errors.messages[error.code]
        raise CharacterError(f"{place(error.lineno)}: not XML ({message})") from None
    except (UnicodeEncodeError, LookupError, ValueError):
        raise CharacterError(f"{place(1)}: not XML (its encoding is not known)") from None
    return builder.roots[0]


class _Builder:
    """Builds elements from the events of a parser."""

    def __init__(
        self, parser: expat.XMLParserType, limits: XmlLimits, place: Callable[[int], str]
    ) -> None:
        self.roots: list[XmlElement] = []
        self._open: list[XmlElement] = []
        self._count = 0
        self._parser, self._limits, self._place = parser, limits, place
        parser.buffer_text = True
        parser.StartElementHandler = self._start
        parser.EndElementHandler = lambda tag: self._open.pop()
        parser.CharacterDataHandler = lambda text: self._open[-1].parts.append(text)
        # Not only entities make much of little: an ATTLIST gives every element its attributes.
        parser.StartDoctypeDeclHandler = lambda *_: self._refuse("DTDs and entities are not read")

    def _start(self, name: str, attributes: dict[str, str]) -> None:
        namespace, _, tag = name.rpartition("}")
        if len(attributes) > MAX_ATTRIBUTES:
            self._refuse(f"an element of more than {MAX_ATTRIBUTES} attributes")
        if max(map(len, (name, *attributes))) > MAX_NAME_CHARS:
            self._refuse(f"a name of more than {MAX_NAME_CHARS} characters")
        if max(map(len, attributes.values()), default=0) > MAX_VALUE_CHARS:
            self._refuse(f"an attribute of more than {MAX_VALUE_CHARS} characters")
        named = {f"{{{key}" if "}" in key else key: value for key, value in attributes.items()}
        self._count += 1
        if self._count > self._limits.elements:
            self._refuse(f"more than {self._limits.elements} elements")
        if len(self._open) >= self._limits.depth:
            self._refuse(f"more than {self._limits.depth} nested elements")
        element = XmlElement(tag, namespace, named, self._parser.CurrentLineNumber)
        (self._open[-1].parts if self._open else self.roots).append(element)
        self._open.append(element)

    def _refuse(self, why: str) -> None:
        raise CharacterError(f"{self._place(self._parser.CurrentLineNumber)}: {why}")
