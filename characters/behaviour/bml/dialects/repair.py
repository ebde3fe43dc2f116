"""Texts that are XML but for little: a DTD that is only named, a prefix that nobody declares.

What is repaired is text; the reader of XML stays as strict and as bounded as it is.
"""

import codecs
import re

from cubeling.characters.errors import CharacterError
from cubeling.characters.xml_elements import XmlElement, XmlLimits, read_xml

UNDECLARED = "urn:cubeling:undeclared:"
"""Namespace of a prefix that a document does not declare, without the prefix."""

MAX_PREFIXES = 32
"""Prefixes that are declared for a document."""

NAMED_ENCODINGS = ("utf-8", "us-ascii", "iso-8859-1", "iso-8859-15", "iso-8859-2", "windows-1252")
"""Encodings that a document may name, besides UTF-16 with its mark."""

_ENCODING = re.compile(rb"<\?xml[^>]{0,100}?encoding\s*=\s*[\"']([\w.-]{1,40})[\"']")
_DOCTYPE = re.compile(
    r"""<!DOCTYPE\s+[\w:.-]+\s*(?:(?:SYSTEM|PUBLIC\s*(?:"[^"<>]*"|'[^'<>]*'))\s*"""
    r"""(?:"[^"<>]*"|'[^'<>]*')\s*)?(?:\[\s*\]\s*)?>"""
)
_ROOT = re.compile(r"""<([A-Za-z_][\w:.-]*)(?:[^"'<>]|"[^"<]*"|'[^'<]*')*>""")
_NAME = r"[A-Za-z_][\w.-]{0,30}"
_PREFIX = re.compile(rf"</?({_NAME}):(?=[A-Za-z_])|\s({_NAME}):[A-Za-z_][\w.-]{{0,60}}\s?=")
_DECLARED = re.compile(r"""\sxmlns:([A-Za-z_][\w.-]{0,30})\s*=""")


def read_repaired(
    document: str | bytes, limits: XmlLimits, notes: list[tuple[int, str]]
) -> XmlElement:
    """Return the root of a document; what was repaired is added to `notes` as line and text.

    Raises
    ------
    CharacterError
        If it is no XML even so, too large, or has a DTD with something in it.
    """
    if len(document) > limits.bytes:
        raise CharacterError(
            f"{_place(1)}: more than {limits.bytes} bytes; write shorter documents"
        )
    text = document if isinstance(document, str) else _decode(document, notes)
    text = text.lstrip("\ufeff \t\r\n")
    begin = _end_of_prolog(text, 0)
    doctype = _DOCTYPE.match(text, begin)
    if doctype is not None:
        line = text.count("\n", 0, begin) + 1
        notes.append((line, "the DTD that it names is not read"))
        # The lines that follow keep their numbers.
        text = text[:begin] + "\n" * doctype[0].count("\n") + text[doctype.end() :]
        begin = _end_of_prolog(text, begin)
    try:
        return read_xml(text, limits, _place)
    except CharacterError:
        declared = _with_prefixes(text, begin, notes)
        if declared == text:
            raise
        return read_xml(declared, limits, _place)


def _decode(document: bytes, notes: list[tuple[int, str]]) -> str:
    """Return the text of bytes in the encoding that they name, or in one that fits."""
    if document.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)):
        return document.decode("utf-16", "replace")
    named = _ENCODING.match(document.removeprefix(codecs.BOM_UTF8))
    first = "utf-8" if named is None else named[1].decode().lower()
    # A text that names UTF-16 and does not begin with its mark is in UTF-8.
    for encoding in dict.fromkeys((first if first in NAMED_ENCODINGS else "utf-8", "utf-8")):
        try:
            return document.decode(encoding)
        except UnicodeDecodeError:
            notes.append((1, f"it is not in {encoding}, as it says"))
    return document.decode("latin-1")


def _end_of_prolog(text: str, at: int) -> int:
    """Return where the declaration, comments and space before the root end."""
    while True:
        while at < len(text) and text[at].isspace():
            at += 1
        for opening, closing in (("<?", "?>"), ("<!--", "-->")):
            if text.startswith(opening, at):
                end = text.find(closing, at)
                if end < 0:
                    return at
                at = end + len(closing)
                break
        else:
            return at


def _with_prefixes(text: str, begin: int, notes: list[tuple[int, str]]) -> str:
    """Return a text whose root declares the prefixes that it does not declare itself."""
    root = _ROOT.match(text, begin)
    if root is None:
        return text
    own = set(_DECLARED.findall(root[0])) | {"xml", "xmlns"}
    missing = dict[str, int]()
    for found in _PREFIX.finditer(text, begin):
        prefix = found[1] or found[2]
        if prefix not in own and prefix not in missing:
            missing[prefix] = found.start()
            if len(missing) >= MAX_PREFIXES:
                break
    at = begin + 1 + len(root[1])
    for prefix, place in missing.items():
        notes.append((text.count("\n", 0, place) + 1, f'nothing declares the prefix "{prefix}:"'))
    declarations = "".join(f' xmlns:{prefix}="{UNDECLARED}{prefix}"' for prefix in missing)
    return text[:at] + declarations + text[at:]


def _place(line: int) -> str:
    return f"BML, line {line}"
