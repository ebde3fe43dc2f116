"""The sections of an .asf file, and the blocks within them."""

from collections.abc import Iterator
from pathlib import Path
from typing import TypeAlias

from characters.formats.mocap.text import refuse, shown

Line: TypeAlias = tuple[int, list[str]]
"""A line's number, from 1, and its words: at least one."""


def read_sections(path: Path, text: str) -> dict[str, list[Line]]:
    """Return the lines of every section `:name`, without comments and empty lines."""
    sections: dict[str, list[Line]] = {}
    current: list[Line] | None = None
    for number, line in enumerate(text.split("\n"), start=1):
        words = line.partition("#")[0].split()
        if not words:
            continue
        if words[0].startswith(":"):
            name = words[0][1:].lower()
            if name in sections:
                raise refuse(path, number, f"a second :{name}", "keep one of them")
            current = sections[name] = []
            if name != "documentation" and words[1:]:
                current.append((number, words[1:]))
        elif current is None:
            raise refuse(
                path, number, f"{shown(words[0])} stands before any section", "is this an .asf?"
            )
        else:
            current.append((number, words))
    return sections


def blocks(path: Path, lines: list[Line]) -> Iterator[tuple[int, list[Line]]]:
    """Yield the lines of every begin … end, and the line of its begin."""
    start = 0
    inside: list[Line] = []
    for number, words in lines:
        word = words[0].lower()
        if word == "begin":
            if start:
                raise refuse(path, number, "begin inside begin", "an end is missing above")
            start, inside = number, []
        elif word == "end":
            if not start:
                raise refuse(path, number, "end without begin", "a begin is missing above")
            yield start, inside
            start = 0
        elif start:
            inside.append((number, words))
        else:
            raise refuse(path, number, f"{shown(words[0])} outside begin … end", "move it inside")
    if start:
        raise refuse(path, start, "this begin has no end", "the file is cut off: export it again")
