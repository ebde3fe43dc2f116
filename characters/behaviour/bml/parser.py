"""Read BML 1.0: one `bml` element, without DTD and entities, of bounded size."""

import re
from collections import Counter
from collections.abc import Collection, Iterable
from typing import Literal

from cubeling.characters.behaviour.bml.document import (
    BML,
    BMLA,
    MAX_BLOCK_S,
    SYNC_NAMES,
    Behaviour,
    Block,
    BmlElement,
    Composition,
    Constraint,
    SyncMark,
    SyncReference,
)
from cubeling.characters.errors import CharacterError
from cubeling.characters.xml_elements import XmlElement, XmlLimits, read_xml

LIMITS = XmlLimits(bytes=1 << 20, elements=5000, depth=32)
"""How large a document may be."""

MAX_BEHAVIOURS = 200
"""Behaviours of a block that is read: more are too many to schedule between two frames."""

MAX_TIED = 500
"""Moments that the constraints of a block tie, as each is scheduled again with the others."""

MAX_MARKS = 500
"""Sync points in the texts of a block."""

MAX_ID_CHARS = 100
"""Longest id: feedback repeats it for every sync point, to all clients."""

MAX_NAMES = 64
"""Blocks that an attribute may name."""

_NUMBER = r"(?:\d+(?:\.\d*)?|\.\d+)(?:[eE][+-]?\d+)?"
SECONDS = re.compile(rf"\s*[+-]?{_NUMBER}\s*")
"""A number of seconds."""

_REFERENCE = re.compile(rf"\s*(?:([^\s:]+):)?([^\s:]+):([^\s:]+?)\s*(?:([+-])\s*({_NUMBER})\s*)?")
_SPACE = re.compile(r"\s+")
COMPOSITION = re.compile(r"(MERGE|REPLACE|APPEND)|APPEND-AFTER\(([^()]*)\)", re.IGNORECASE)
"""What the standard and AsapRealizer let a block do with those before it."""


def parse(document: str | bytes) -> Block:
    """Return what a BML document says.

    Raises
    ------
    CharacterError
        If it is no XML, declares a DTD, is too large, or is no block that can be understood.
    """
    return parse_as(document, ("bml",))


def parse_as(document: str | bytes, roots: Collection[str]) -> Block:
    """Return what a document says that is written as BML is, but whose root has another name.

    Elements of these names inside it are read as if what they contain stood there itself.

    Raises
    ------
    CharacterError
        As for `parse`.
    """
    root = read_xml(document, LIMITS, _place)
    if root.tag not in roots or not _standard(root):
        raise _error(root, f"<{root.tag}> is no <{'> or <'.join(roots)}> of namespace {BML}")
    block = block_of_elements(root, roots)
    if not block.id:
        raise _error(root, "a block without an id; write <bml id=…>")
    return block


def block_of_elements(root: XmlElement, roots: Collection[str]) -> Block:
    """Return what an element says that is written as `bml` is; its id may be missing.

    Raises
    ------
    CharacterError
        If it is no block that can be understood.
    """
    return _DocumentReader(root, roots).block()


def reference(text: str) -> SyncReference:
    """Return the moment that a text names.

    >>> reference("bml1:speech1:s1 + 0.5")
    SyncReference(behaviour='speech1', sync='s1', block='bml1', offset=0.5)
    >>> reference("6").offset
    6.0

    Raises
    ------
    CharacterError
        If it names none.
    """
    found = _REFERENCE.fullmatch(text)
    if found is None and not SECONDS.fullmatch(text):
        raise CharacterError(
            f'"{text[:MAX_ID_CHARS]}" is no moment; write 1.5, speech1:start or speech1:start+0.5'
        )
    offset = float(text) if found is None else float((found[4] or "") + (found[5] or "0"))
    if not abs(offset) <= MAX_BLOCK_S:
        raise CharacterError(
            f'"{text[:MAX_ID_CHARS]}" is farther than {MAX_BLOCK_S:g} s; give fewer seconds'
        )
    if found is None:
        return SyncReference(offset=offset)
    return SyncReference(found[2], found[3], found[1] or "", offset)


class _DocumentReader:
    """Makes a block of a `bml` element."""

    def __init__(self, root: XmlElement, roots: Collection[str]) -> None:
        self._root, self._roots = root, roots
        self._behaviours: list[Behaviour] = []
        self._constraints: list[Constraint] = []
        self._ids: set[str] = set()
        self._numbers = Counter[str]()
        self._tied = self._marks = 0

    def block(self) -> Block:
        given = dict(self._root.attributes)
        name = _id(self._root, given.pop("id", ""))
        self._read(self._root.children, required=False)
        composition, after = self._composition(given.pop("composition", "MERGE"))
        return Block(
            id=name,
            behaviours=tuple(self._behaviours),
            constraints=tuple(self._constraints),
            composition=composition,
            append_after=after + self._names(given.pop(f"{{{BMLA}}}appendAfter", "")),
            chunk_after=self._names(given.pop(f"{{{BMLA}}}chunkAfter", "")),
            interrupt=self._names(given.pop(f"{{{BMLA}}}interrupt", "")),
            on_start=self._names(given.pop(f"{{{BMLA}}}onStart", "")),
            preplan=given.pop(f"{{{BMLA}}}preplan", "").strip().lower() in ("true", "1"),
            character=_id(self._root, given.pop("characterId", "")),
            attributes=given,
        )

    def _read(self, elements: Iterable[XmlElement], required: bool) -> None:
        for element in elements:
            if _standard(element) and element.tag == "required":
                self._read(element.children, required=True)
            elif _standard(element) and element.tag in self._roots:
                self._read(element.children, required)
            elif _standard(element) and element.tag == "constraint":
                self._read_constraint(element, required)
            else:
                self._behaviours.append(self._behaviour(element, required))

    def _behaviour(self, element: XmlElement, required: bool) -> Behaviour:
        name = _id(element, element.attributes.get("id", "")) or self._new_id(element.tag)
        if name in self._ids:
            raise _error(element, f'a second behaviour with id "{name}"; give each its own')
        self._ids.add(name)
        if len(self._behaviours) >= MAX_BEHAVIOURS:
            raise _error(element, f"more than {MAX_BEHAVIOURS} behaviours; send several blocks")
        text, marks = _speech(element) if element.tag == "speech" else ("", ())
        self._marks += len(marks)
        if self._marks > MAX_MARKS:
            raise _error(
                element, f"more than {MAX_MARKS} sync points in texts; send several blocks"
            )
        given = element.attributes.items()
        return Behaviour(
            id=name,
            kind=element.tag,
            namespace=element.namespace or BML,
            syncs={key: _moment(element, v) for key, v in given if key in SYNC_NAMES},
            attributes={k: v for k, v in given if k not in SYNC_NAMES and k != "id"},
            children=tuple(_as_element(child) for child in element.children),
            text=text,
            marks=marks,
            required=required,
            line=element.line,
        )

    def _new_id(self, tag: str) -> str:
        # Ids are never given back, so a number that is taken stays taken.
        self._numbers[tag] += 1
        while f"{tag}{self._numbers[tag]}" in self._ids:
            self._numbers[tag] += 1
        return f"{tag}{self._numbers[tag]}"

    def _read_constraint(self, element: XmlElement, required: bool) -> None:
        for rule in element.children:
            if rule.tag not in ("synchronize", "before", "after"):
                raise _error(rule, f"<{rule.tag}> is no synchronize, before or after")
            kind: Literal["synchronize", "before", "after"] = rule.tag  # type: ignore[assignment]
            syncs = tuple(
                _moment(sync, sync.attributes.get("ref", ""))
                for sync in rule.children
                if sync.tag == "sync"
            )
            other = rule.attributes.get("ref")
            if other is None and kind != "synchronize":
                raise _error(rule, f"a <{kind}> without ref; say {kind} what")
            moment = None if other is None else _moment(rule, other)
            if kind == "synchronize" and moment is not None:
                syncs, moment = (moment, *syncs), None
            name = _id(element, element.attributes.get("id", ""))
            name = self._new_id("constraint") if not name or name in self._ids else name
            self._ids.add(name)
            self._tied += len(syncs) + (moment is not None)
            if self._tied > MAX_TIED:
                raise _error(
                    rule, f"constraints tie more than {MAX_TIED} moments; send several blocks"
                )
            self._constraints.append(Constraint(kind, syncs, moment, name, required))

    def _names(self, text: str) -> tuple[str, ...]:
        names = tuple(text.replace(",", " ").split())
        if len(names) > MAX_NAMES:
            raise _error(self._root, f"more than {MAX_NAMES} blocks named in an attribute")
        return names

    def _composition(self, text: str) -> tuple[Composition, tuple[str, ...]]:
        found = COMPOSITION.fullmatch(text.strip())
        if found is None:
            known = "MERGE, APPEND, REPLACE, APPEND-AFTER(ids)"
            raise _error(self._root, f'composition "{text[:MAX_ID_CHARS]}" is none of {known}')
        if found[2] is not None:
            return "MERGE", self._names(found[2])
        composition: Composition = found[1].upper()  # type: ignore[assignment]
        return composition, ()


def _speech(element: XmlElement) -> tuple[str, tuple[SyncMark, ...]]:
    """Return the text of a speech with single spaces, and its marks."""
    written, marks, length = list[str](), list[SyncMark](), 0

    def add(parts: Iterable[str | XmlElement]) -> None:
        nonlocal length
        for part in parts:
            if isinstance(part, XmlElement):
                if part.tag == "sync" and part.attributes.get("id"):
                    marks.append(SyncMark(_id(part, part.attributes["id"]), length))
                add(part.parts)
                continue
            words = _SPACE.sub(" ", part)
            if words.startswith(" ") and (not written or written[-1].endswith(" ")):
                words = words[1:]
            if words:
                written.append(words)
                length += len(words)

    add([child for child in element.children if child.tag in ("text", "ssml", "description")])
    _check_marks(element, marks)
    text = "".join(written).rstrip()
    return text, tuple(SyncMark(mark.id, min(mark.at, len(text))) for mark in marks)


def _check_marks(element: XmlElement, marks: list[SyncMark]) -> None:
    for name, count in Counter([*(mark.id for mark in marks), "start", "end"]).items():
        if count > 1:
            raise _error(element, f'a second sync point "{name}" in a text; give each its own id')


def _as_element(element: XmlElement) -> BmlElement:
    return BmlElement(
        element.tag,
        element.namespace or BML,
        element.attributes,
        tuple(_as_element(child) for child in element.children),
        element.text,
    )


def _moment(element: XmlElement, text: str) -> SyncReference:
    try:
        return reference(text)
    except CharacterError as error:
        raise _error(element, str(error)) from None


def _standard(element: XmlElement) -> bool:
    """Return whether an element is of the standard; those without a namespace are."""
    return element.namespace in ("", BML)


def _id(element: XmlElement, text: str) -> str:
    """Return an id, "" if there is none."""
    name = text.strip()
    if len(name) > MAX_ID_CHARS:
        raise _error(element, f"an id of more than {MAX_ID_CHARS} characters; give a shorter one")
    return name


def _place(line: int) -> str:
    return f"BML, line {line}"


def _error(element: XmlElement, message: str) -> CharacterError:
    return CharacterError(f"{_place(element.line)}: {message}")
