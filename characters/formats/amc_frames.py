"""The frames of an .amc file: which bone moves how, checked against the .asf."""

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import compress, cycle
from pathlib import Path

import numpy as np

from characters.errors import CharacterError
from characters.formats.asf import Acclaim
from characters.formats.motion_text import number, numbers, refuse, shown
from characters.pose import Array

_RATE = 120.0  # [Hz] of the CMU database, where files do not say
_BLOCK = 1 << 22  # characters to cut into words at once


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


def _frames(path: Path, text: str, header: Header) -> Iterator[_Frame]:
    """Yield frames line by line, refusing what is not one."""
    frame: _Frame | None = None
    lines = text[header.characters :].split("\n")
    for line, content in enumerate(lines, start=header.lines + 1):
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


def read_values(
    path: Path, text: str, header: Header, body: Acclaim
) -> tuple[Array, tuple[str, ...]]:
    """Return the numbers of all frames, (frames, numbers of a frame), and notes."""
    columns = body.columns
    first = next(_frames(path, text[: header.characters + _BLOCK], header))
    _row(path, body, columns, first, first)
    table = _uniform(text[header.characters :], columns, first)
    if table is None:  # frames differ in what they hold, or one is bad: look line by line
        table = _differing(path, text, header, body, first)
    counts, values = table
    notes = [
        f"{bone.name} does not move: the .amc does not mention it"
        for bone in body.bones
        if bone.dof and bone.name not in first.rows
    ]
    if (np.diff(counts) != 1).any():
        notes.append("the numbers of the frames have gaps; frames are taken as they follow")
    return values, tuple(notes)


def _uniform(text: str, columns: dict[str, slice], first: _Frame) -> tuple[Array, Array] | None:
    """Return frame numbers and values of frames that list the same bones in the same order.

    They are cut into words a block at a time, and never into lines. None if they are not so.
    """
    names = {}  # where in a frame which name stands
    order = [0]  # where in the values, after the frame's number, each number goes
    mask = [True]  # which words of a frame are numbers
    for name, (_, words) in first.rows.items():
        names[len(mask)] = name
        mask += [False] + [True] * len(words)
        order += range(columns[name].start + 1, columns[name].stop + 1)
    period, width = len(mask), 1 + max(part.stop for part in columns.values())
    tables: list[Array] = []
    carried: list[str] = []
    start = 0
    while start < len(text):
        end = text.find("\n", start + _BLOCK)
        end = len(text) if end < 0 else end
        words = carried + text[start:end].split()
        whole = len(words) - len(words) % period
        frames, carried, start = whole // period, words[whole:], end
        del words[whole:]
        if any(words[at::period] != [name] * frames for at, name in names.items()):
            return None
        found = numbers(compress(words, cycle(mask)))
        if found is None:
            return None
        table = np.zeros((frames, width))
        table[:, order] = found.reshape(frames, len(order))
        tables.append(table)
    if carried:
        return None
    whole_table = np.concatenate(tables)
    return whole_table[:, 0], whole_table[:, 1:]


def _differing(
    path: Path, text: str, header: Header, body: Acclaim, first: _Frame
) -> tuple[Array, Array]:
    """Return frame numbers and values of frames that list bones in any order."""
    columns = body.columns
    counts, rows = [], []
    for frame in _frames(path, text, header):
        counts.append(float(frame.number))
        rows.append(_row(path, body, columns, frame, first))
    return np.array(counts), np.array(rows)


def _row(
    path: Path, body: Acclaim, columns: dict[str, slice], frame: _Frame, first: _Frame
) -> Array:
    """Return the numbers of one frame, in the order of the skeleton, or refuse it."""
    row = np.zeros(max(part.stop for part in columns.values()))
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
    return row
