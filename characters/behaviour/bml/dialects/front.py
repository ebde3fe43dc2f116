"""From a dialect's elements to those of BML 1.0, with a note for each line that is changed.

Source of the dialects: the draft of 2007 (Vilhjálmsson et al.), Greta's BML and FML-APML (Mancini
and Pelachaud 2008), and SmartBody's (Thiébaux et al. 2008). What a document means is kept as far as
it can be told from it; what nobody here can do is left to the realizer, which warns of it.
"""

import re
from collections import Counter
from dataclasses import replace

from cubeling.characters.behaviour.bml import parser
from cubeling.characters.behaviour.bml.dialects.kinds import CONVERSIONS, convert
from cubeling.characters.behaviour.bml.dialects.repair import UNDECLARED, read_repaired
from cubeling.characters.behaviour.bml.dialects.times import mend_times
from cubeling.characters.behaviour.bml.document import BML, BMLA, SYNCS, Block
from cubeling.characters.behaviour.bml.parser import block_of_elements
from cubeling.characters.errors import CharacterError
from cubeling.characters.xml_elements import XmlElement

CONTAINER_TAGS = ("bml", "act", "fml", "fml-apml")
"""Elements whose content is read as if it stood where they stand."""

SILENT = {
    "lip": "the mouth follows the voice",
    "lips": "the mouth follows the voice",
    "viseme": "the mouth follows the voice",
    "curves": "face and head follow the voice",
    "saccade": "eyes dart by themselves",
    "event": "no messages are sent",
    "boundary": "the voice pauses where it wants",
    "intonation_break": "the voice pauses where it wants",
    "intonation_tone": "the voice has its own melody",
    "turn": "whose turn it is, nobody keeps",
    "blink": "eyes blink by themselves",
    "interrupt": "nothing is interrupted by it",
}
"""Elements that are left out, and why: there is nothing to show, or it comes by itself."""

KNOWN_URIS = (
    "mindmakers.org",
    "bml-initiative.org",
    "saibabml",
    "ict.usc.edu",
    "smartbody",
    "greta",
)
"""Parts of the namespaces of dialects, in lower case."""

NAMING = frozenset({"lexeme", "type", "name", "au", "target", "start", "text"})
"""Attributes that tell what a behaviour does, or when: one without them adds to another."""

SMARTBODY = frozenset({"joint-range", "action", "participant"})
"""Attributes of SmartBody's that are read."""

_CHUNK_AFTER = re.compile(r"CHUNK-AFTER\(([^()]*)\)", re.IGNORECASE)

MAX_NOTES = 200
"""Notes of one document; more are counted."""


def parse_dialect(document: str | bytes) -> Block:
    """Return what a document of BML says, or of a draft or dialect of it; see `Block.notes`.

    Raises
    ------
    CharacterError
        If it is no XML, has a DTD with something in it, is too large, or has no behaviours.
    """
    notes: list[tuple[int, str]] = []
    root = read_repaired(document, parser.LIMITS, notes)
    front = _Front(notes)
    if root.tag not in (*CONTAINER_TAGS, *SYNCS, *CONVERSIONS):
        known = f"<{'>, <'.join(CONTAINER_TAGS)}>"
        raise CharacterError(f"BML, line {root.line}: <{root.tag}> is no {known} nor a behaviour")
    block = block_of_elements(front.standard(root), CONTAINER_TAGS)
    lines = sorted(dict.fromkeys(notes))
    texts = [f"line {line}: {text}" for line, text in lines[:MAX_NOTES]]
    if len(lines) > MAX_NOTES:
        texts.append(f"and {len(lines) - MAX_NOTES} more of the kind")
    behaviours = tuple(replace(each, yielding=not each.required) for each in block.behaviours)
    return replace(block, behaviours=behaviours, notes=tuple(texts))


class _Front:
    """Turns the root of a dialect into a `bml` element of the standard."""

    def __init__(self, notes: list[tuple[int, str]]) -> None:
        self._notes = notes
        self._found: list[tuple[XmlElement, bool]] = []
        self._ids: dict[str, XmlElement] = {}
        self._numbers = Counter[str]()
        self._left_out: dict[str, list[int]] = {}
        self._block: dict[str, str] = {}

    def standard(self, root: XmlElement) -> XmlElement:
        """Return a `bml` element with the behaviours of a root, in the standard's form."""
        self._read(root)
        if not self._found and not self._left_out and not self._block.get("id"):
            raise CharacterError(
                f"BML, line {root.line}: a block without an id, in which nothing is to be done"
            )
        made: list[tuple[XmlElement, bool]] = []
        for element, required in self._found:
            free = element.namespace or element.tag == "constraint"
            parts = [element] if free else convert(element, self._notes)
            made += [(part, required) for part in parts]
        for tag, lines in self._left_out.items():
            times = f", {len(lines)} times" if len(lines) > 1 else ""
            self._notes.append((lines[0], f"<{tag}> is left out{times}: {SILENT[tag]}"))
        mend_times([each for each, _ in made if each.tag != "constraint"], self._notes)
        inside = [
            XmlElement("required", "", {}, each.line, [each]) if required else each
            for each, required in made
        ]
        return XmlElement("bml", "", {"id": "", **self._block}, root.line, [*inside])

    def _read(self, element: XmlElement, required: bool = False) -> None:
        """Find the behaviours of an element, which may be one itself."""
        was = element.namespace
        _make_plain(element)
        if element.tag in CONTAINER_TAGS:
            element.namespace = ""
        if was not in ("", BML) and not element.namespace and element.tag in CONTAINER_TAGS:
            self._notes.append((element.line, f"namespace {was} is read as that of BML 1.0"))
        inside = required or element.tag == "required"
        if element.namespace or element.tag == "constraint":
            self._found.append((element, required))
        elif element.tag in CONTAINER_TAGS or element.tag == "required":
            if element.tag == "bml":
                self._take_attributes(element)
            for child in element.children:
                self._read(child, inside)
        elif element.tag == "participant":
            self._block.setdefault("characterId", element.attributes.get("id", "").strip())
        elif element.tag in SILENT:
            self._left_out.setdefault(element.tag, []).append(element.line)
        elif self._is_new(element):
            self._found.append((element, required))

    def _is_new(self, element: XmlElement) -> bool:
        """Return whether an element is another behaviour; if its id is taken, it gets its own.

        One that only has more to say of an earlier one is added to that.
        """
        name = element.attributes.get("id", "").strip()
        if not name or len(self._ids) > parser.MAX_BEHAVIOURS:  # the parser refuses so many
            return True
        first = self._ids.get(name)
        if first is not None and first.tag == element.tag and not _names_something(element):
            first.attributes.update(element.attributes)
            first.parts += element.parts
            return False
        if first is not None:
            again = self._next_id(name)
            self._notes.append((element.line, f'a second "{name}" is called "{again}"'))
            element.attributes["id"] = name = again
        self._ids[name] = element
        return True

    def _next_id(self, name: str) -> str:
        # Ids are never given back, so a number that is taken stays taken.
        self._numbers[name] += 1
        while f"{name}-{self._numbers[name] + 1}" in self._ids:
            self._numbers[name] += 1
        return f"{name}-{self._numbers[name] + 1}"

    def _take_attributes(self, root: XmlElement) -> None:
        """Keep the attributes of a block that the standard has."""
        for key, value in root.attributes.items():
            if key == "character":
                key = "characterId"
            elif key == "composition":
                chunk = _CHUNK_AFTER.fullmatch(value.strip())
                if chunk is not None:
                    key, value = f"{{{BMLA}}}chunkAfter", chunk[1]
                elif not parser.COMPOSITION.fullmatch(value.strip()):
                    value = "MERGE"  # Greta's "blend", and whatever others call it
            self._block.setdefault(key, value)


def _names_something(element: XmlElement) -> bool:
    """Return whether an element tells by itself what is to be done."""
    return bool(element.parts) or not NAMING.isdisjoint(element.attributes)


def _make_plain(element: XmlElement) -> None:
    """Take the namespaces of dialects off an element and its attributes."""
    if element.namespace == f"{UNDECLARED}bmla":
        element.namespace = BMLA
    elif _is_dialect(element.namespace, element.tag):
        element.namespace = ""
    for key in [key for key in element.attributes if key.startswith("{")]:
        namespace, _, name = key[1:].partition("}")
        if _is_dialect(namespace, name):
            element.attributes.setdefault(name, element.attributes[key])


def _is_dialect(namespace: str, name: str) -> bool:
    """Return whether a name of a namespace is one that dialects of BML have."""
    if namespace.startswith(UNDECLARED):
        return name in SYNCS or name in CONVERSIONS or name in SILENT or name in SMARTBODY
    lower = namespace.lower()
    return namespace in ("", BML) or any(part in lower for part in KNOWN_URIS)
