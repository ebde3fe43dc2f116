"""The frames of an .amc file: which bone moves how, checked against the .asf."""

import re
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import compress, cycle
from pathlib import Path

import numpy as np

from characters.errors import CharacterError
from characters.formats.mocap.asf import Acclaim
from characters.formats.mocap.text import number, numbers, refuse, shown
from characters.skeleton.pose import Array

_RATE = 120.0  # [Hz] of the CMU database, where files do not say
_BLOCK = 1 << 22  # characters to cut into words at once
_FRAME_NUMBER = re.compile(r"\n[ \t]*\d{1,11}[ \t]*\n")


@dataclass(frozen=True)
class Header:
    """What stands above the first frame."""

    radians: float
    """How much an angle of 1 is [rad]."""

    rate: float
    """Frames a second [Hz]."""

    lines: int
    """How many lines it has."""

    characters: int
    """How long it is: the first frame starts there."""


def read_header(path: Path, text: str, radians: float) -> Header:
    """Read the lines before the first frame; angles are as in the .asf if they do not say."""
    rate, start, line = _RATE, 0, 0
    while start < len(text):
        end = text.find("\n", start)
        end = len(text) if end < 0 else end
        words = text[start:end].partition("#")[0].split()
        if words and not words[0].startswith(":"):
            return Header(radians, rate, line, start)
        line += 1
        start = end + 1
        key = words[0].upper() if words else ""
        if key in (":DEGREES", ":RADIANS"):
            radians = 1.0 if key == ":RADIANS" else float(np.pi / 180)
        elif key == ":SAMPLES-PER-SECOND" and len(words) > 1:
            rate = number(path, line, words[1])
    raise CharacterError(f"{path}: has no frames; is this a whole .amc?")


@dataclass(frozen=True)
class _Frame:
    """The words of one frame, and where they stand."""

    line: int
    """The line of its number, from 1."""

    number: int
    """As in the file."""

    rows: dict[str, tuple[int, list[str]]]
    """Every bone's line and numbers."""


def read_values(
    path: Path, text: str, header: Header, body: Acclaim
) -> tuple[Array, tuple[str, ...]]:
    """Return the numbers of all frames, (frames, numbers of a frame), and notes.

    Raises
    ------
    CharacterError
        If a frame does not fit the skeleton, with the line that is at fault.
    """
    columns = body.columns
    blocks = list(_blocks(text, header.characters))
    first = next(_frames(path, text, blocks[0], header.lines))
    _row(path, body, columns, first, first)
    tables: list[Array] = []
    for block in blocks:
        table = _uniform(text[slice(*block)], columns, first)
        if table is None:  # its frames differ in what they hold, or one is bad
            line = text.count("\n", 0, block[0])
            frames = _frames(path, text, block, line)
            table = np.array([_row(path, body, columns, frame, first) for frame in frames])
        tables.append(table)
    table = np.concatenate(tables)
    notes = [
        f"{bone.name} does not move: the .amc does not mention it"
        for bone in body.bones
        if bone.dof and bone.name not in first.rows
    ]
    if (np.diff(table[:, 0]) != 1).any():
        notes.append("the numbers of the frames have gaps; frames are taken as they follow")
    return table[:, 1:], tuple(notes)


def _blocks(text: str, start: int) -> Iterator[tuple[int, int]]:
    """Yield where blocks of whole frames begin and end in a text."""
    while start < len(text):
        found = _FRAME_NUMBER.search(text, start + _BLOCK)
        end = found.start() + 1 if found else len(text)
        yield start, end
        start = end


def _frames(path: Path, text: str, block: tuple[int, int], lines: int) -> Iterator[_Frame]:
    """Yield the frames of a block after so many lines, line by line, refusing what is none."""
    frame: _Frame | None = None
    for line, content in enumerate(text[slice(*block)].split("\n"), start=lines + 1):
        words = content.partition("#")[0].split()
        if not words:
            continue
        if len(words) == 1 and words[0].isdecimal() and len(words[0]) < 12:
            if frame is not None:
                yield frame
            frame = _Frame(line, int(words[0]), {})
        elif frame is None:
            raise refuse(
                path,
                line,
                f"{shown(words[0])} stands before the number of the first frame",
                "is this an .amc?",
            )
        elif words[0] in frame.rows:
            raise refuse(
                path,
                line,
                f"frame {frame.number} moves {shown(words[0])} twice",
                "a frame number is missing: export it again",
            )
        else:
            frame.rows[words[0]] = (line, words[1:])
    if frame is not None:
        yield frame


def _uniform(text: str, columns: dict[str, slice], first: _Frame) -> Array | None:
    """Return a block's frames, which list the bones of the first in the same order.

    A row is a frame's number and its values. The text is cut into words and never into lines,
    which is what makes it fast. None if a frame is not so.
    """
    names = {}  # where in a frame which name stands
    order = [0]  # where in a row each number goes
    mask = [True]  # which words of a frame are numbers
    for name, (_, words) in first.rows.items():
        names[len(mask)] = name
        mask += [False] + [True] * len(words)
        order += range(columns[name].start + 1, columns[name].stop + 1)
    tokens, period = text.split(), len(mask)
    frames = len(tokens) // period
    if frames * period != len(tokens):
        return None
    if any(tokens[at::period] != [name] * frames for at, name in names.items()):
        return None
    found = numbers(compress(tokens, cycle(mask)))
    if found is None:
        return None
    table = np.zeros((frames, 1 + _width(columns)))
    table[:, order] = found.reshape(frames, len(order))
    return table


def _width(columns: dict[str, slice]) -> int:
    """Return how many numbers a frame has."""
    return max(int(part.stop) for part in columns.values())


def _row(
    path: Path, body: Acclaim, columns: dict[str, slice], frame: _Frame, first: _Frame
) -> Array:
    """Return the number and the values of a frame, in the skeleton's order, or refuse it."""
    row = np.zeros(_width(columns))
    for name, (line, words) in frame.rows.items():
        if name not in columns:
            raise refuse(
                path,
                line,
                f"{body.path.name} has no bone {shown(name)}",
                "give the .asf of the same performer with skeleton=",
            )
        part = columns[name]
        if len(words) != part.stop - part.start:
            raise refuse(
                path,
                line,
                f"{shown(name)} has {len(words)} numbers, and in {body.path.name} "
                f"{part.stop - part.start} degrees of freedom",
                "give the .asf of the same performer, or export again",
            )
        row[part] = [number(path, line, word) for word in words]
    missing = [name for name in first.rows if name not in frame.rows]
    if missing or not frame.rows:
        lacking = shown(missing[0]) if missing else "any bone"
        raise refuse(
            path,
            frame.line,
            f"frame {frame.number} lacks {lacking}",
            "the file is cut off or edited: export it again",
        )
    return np.concatenate([[frame.number], row])
