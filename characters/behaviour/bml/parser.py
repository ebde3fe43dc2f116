"""Read BML 1.0: one `bml` element, without DTD and entities, of bounded size."""

import math
import re
from collections.abc import Collection, Iterable
from typing import Literal

from cubeling.characters.behaviour.bml.document import (
    BML,
    BMLA,
    SYNC_NAMES,
    Behaviour,
    Block,
    BmlElement,
    Composition,
    Constraint,
    SyncMark,
    SyncReference,
)
from cubeling.characters.behaviour.bml.xml_elements import OpenElement, read_xml
from cubeling.characters.errors import CharacterError

MAX_BEHAVIOURS = 200
"""Behaviours of a block that is read: more are too many to schedule between two frames."""

MAX_OFFSET = 1e6
"""Seconds that a moment may be from another."""

_NUMBER = r"(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?"
SECONDS = re.compile(rf"\s*[+-]?{_NUMBER}\s*")
"""A number of seconds."""

_REFERENCE = re.compile(rf"\s*(?:([^\s:]+):)?([^\s:]+):([^\s:]+?)\s*(?:([+-])\s*({_NUMBER})\s*)?")
_COMPOSITION = re.compile(r"(MERGE|REPLACE|APPEND)|APPEND-AFTER\(([^()]*)\)", re.IGNORECASE)


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
    root = read_xml(document)
    if root.tag not in roots or root.namespace != BML:
        raise _error(root, f"<{root.tag}> is no <{'> or <'.join(roots)}> of namespace {BML}")
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
            f'"{text}" is no moment; write 1.5, speech1:start or speech1:start+0.5'
        )
    offset = float(text) if found is None else float((found[4] or "") + (found[5] or "0"))
    if not math.isfinite(offset) or abs(offset) > MAX_OFFSET:
        raise CharacterError(f'"{text}" is farther than {MAX_OFFSET:g} s; give fewer seconds')
    if found is None:
        return SyncReference(offset=offset)
    return SyncReference(found[2], found[3], found[1] or "", offset)


class _DocumentReader:
    """Makes a block of a `bml` element."""

    def __init__(self, root: OpenElement, roots: Collection[str]) -> None:
        self._root, self._roots = root, roots
        self._behaviours: list[Behaviour] = []
        self._constraints: list[Constraint] = []
        self._ids: set[str] = set()

    def block(self) -> Block:
        given = dict(self._root.attributes)
        name = given.pop("id", "").strip()
        if not name:
            raise _error(self._root, "a block without an id; write <bml id=…>")
        self._read(self._root.children, required=False)
        composition, after = self._composition(given.pop("composition", "MERGE"))
        return Block(
            id=name,
            behaviours=tuple(self._behaviours),
            constraints=tuple(self._constraints),
            composition=composition,
            append_after=after + _names(given.pop(f"{{{BMLA}}}appendAfter", "")),
            chunk_after=_names(given.pop(f"{{{BMLA}}}chunkAfter", "")),
            interrupt=_names(given.pop(f"{{{BMLA}}}interrupt", "")),
            on_start=_names(given.pop(f"{{{BMLA}}}onStart", "")),
            preplan=given.pop(f"{{{BMLA}}}preplan", "").strip().lower() in ("true", "1"),
            character=given.pop("characterId", ""),
            attributes=given,
        )

    def _read(self, elements: Iterable[OpenElement], required: bool) -> None:
        for element in elements:
            if element.namespace == BML and element.tag == "required":
                self._read(element.children, required=True)
            elif element.namespace == BML and element.tag in self._roots:
                self._read(element.children, required)
            elif element.namespace == BML and element.tag == "constraint":
                self._read_constraint(element, required)
            else:
                self._behaviours.append(self._behaviour(element, required))

    def _behaviour(self, element: OpenElement, required: bool) -> Behaviour:
        name = element.attributes.get("id", "").strip() or self._new_id(element.tag)
        if name in self._ids:
            raise _error(element, f'a second behaviour with id "{name}"; give each its own')
        self._ids.add(name)
        if len(self._behaviours) >= MAX_BEHAVIOURS:
            raise _error(element, f"more than {MAX_BEHAVIOURS} behaviours; send several blocks")
        text, marks = _speech(element) if element.tag == "speech" else ("", ())
        given = element.attributes.items()
        return Behaviour(
            id=name,
            kind=element.tag,
            namespace=element.namespace,
            syncs={key: _moment(element, v) for key, v in given if key in SYNC_NAMES},
            attributes={k: v for k, v in given if k not in SYNC_NAMES and k != "id"},
            children=tuple(_as_element(child) for child in element.children),
            text=text,
            marks=marks,
            required=required,
        )

    def _new_id(self, tag: str) -> str:
        number = 1
        while f"{tag}{number}" in self._ids:
            number += 1
        return f"{tag}{number}"

    def _read_constraint(self, element: OpenElement, required: bool) -> None:
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
            name = element.attributes.get("id", "").strip()
            name = self._new_id("constraint") if not name or name in self._ids else name
            self._ids.add(name)
            self._constraints.append(Constraint(kind, syncs, moment, name, required))

    def _composition(self, text: str) -> tuple[Composition, tuple[str, ...]]:
        found = _COMPOSITION.fullmatch(text.strip())
        if found is None:
            raise _error(
                self._root,
                f'composition "{text}" is none of MERGE, APPEND, REPLACE, APPEND-AFTER(ids)',
            )
        if found[2] is not None:
            return "MERGE", _names(found[2])
        composition: Composition = found[1].upper()  # type: ignore[assignment]
        return composition, ()


def _speech(element: OpenElement) -> tuple[str, tuple[SyncMark, ...]]:
    """Return the text of a speech with single spaces, and its marks."""
    text, marks = "", list[SyncMark]()

    def add(parts: Iterable[str | OpenElement]) -> None:
        nonlocal text
        for part in parts:
            if isinstance(part, OpenElement):
                if part.tag == "sync" and part.attributes.get("id"):
                    marks.append(SyncMark(part.attributes["id"].strip(), len(text)))
                add(part.parts)
                continue
            for character in part:
                if not character.isspace():
                    text += character
                elif text and text[-1] != " ":
                    text += " "

    add([child for child in element.children if child.tag in ("text", "ssml", "description")])
    _check_marks(element, marks)
    text = text.rstrip()
    return text, tuple(SyncMark(mark.id, min(mark.at, len(text))) for mark in marks)


def _check_marks(element: OpenElement, marks: list[SyncMark]) -> None:
    names = [mark.id for mark in marks] + ["start", "end"]
    for name in names:
        if names.count(name) > 1:
            raise _error(element, f'a second sync point "{name}" in a text; give each its own id')


def _as_element(element: OpenElement) -> BmlElement:
    return BmlElement(
        element.tag,
        element.namespace,
        element.attributes,
        tuple(_as_element(child) for child in element.children),
        element.text,
    )


def _moment(element: OpenElement, text: str) -> SyncReference:
    try:
        return reference(text)
    except CharacterError as error:
        raise _error(element, str(error)) from None


def _names(text: str) -> tuple[str, ...]:
    return tuple(text.replace(",", " ").split())


def _error(element: OpenElement, message: str) -> CharacterError:
    return CharacterError(f"BML, line {element.line}: {message}")
