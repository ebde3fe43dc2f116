"""Acclaim motions (.amc), which say how the bones of an .asf move, frame by frame."""

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import compress, cycle
from pathlib import Path

import numpy as np

from characters.clip import Clip
from characters.errors import CharacterError
from characters.formats import asf
from characters.formats.motion_frame import settle
from characters.formats.motion_text import (
    check_size,
    number,
    numbers,
    read_text,
    refuse,
    shown,
)
from characters.formats.performance import Performance
from characters.pose import Array

_RATE = 120.0  # of the CMU database, where files do not say
_BLOCK = 1 << 22  # characters to cut into words at once


def load(
    path: "str | Path",
    skeleton: "str | Path | None" = None,
    *,
    rate: float | None = None,
    scale: float | None = None,
    up: str | None = None,
) -> Performance:
    """Read an .amc file and the .asf that goes with it.

    Every joint's rest rotation is the identity: joints keep the axes of the file, so the bones'
    own frames are folded into the motion. Joints are called as the bones are, the hips "root";
    the ends of last bones are joints too, called ``ltoes_end``.

    Parameters
    ----------
    path
        The .amc file.
    skeleton
        The .asf file. Left out, it is the one beside the motion that is called as it is or as
        the first part of its name (16_08.amc: 16.asf), or the only one there.
    rate
        Frames a second [Hz]; left out, what the file says, or 120.
    scale
        Metres a unit; left out, 0.0254 over the `length` of the .asf, as CMU means it, if that
        makes a performer of 0.5 to 2.5 m, else recognised by size.
    up
        The axis that points up: "y", "z", "-y", …. Left out, it is the one from feet to head.

    Raises
    ------
    CharacterError
        If one of the files is absent or cannot be read, with the line that is at fault.
    """
    path = Path(path)
    text = read_text(path)
    body = asf.load(Path(skeleton) if skeleton is not None else find_skeleton(path))
    header = _header(path, text, body.radians)
    rate = rate if rate is not None else header.rate
    if not 0 < rate < 1e5:
        raise CharacterError(f"{path}: {rate:g} frames a second is no rate; give rate= in Hz")
    values, notes = _values(path, text, header, body)
    check_size(path, len(body.skeleton), len(values))
    poses = body.channels(header.radians).poses(values)
    settled = settle(path, body.skeleton, poses, scale=scale, up=up, stated=body.unit)
    clip = Clip(path.stem, rate, settled.poses, loop=False)
    return Performance(settled.skeleton, clip, notes + settled.notes)


def find_skeleton(path: Path) -> Path:
    """Return the .asf beside an .amc.

    Raises
    ------
    CharacterError
        If there is none, or if there are several and none is called as the motion is.
    """
    try:
        beside = sorted(p for p in path.parent.iterdir() if p.suffix.lower() == ".asf")
    except OSError as error:
        raise CharacterError(
            f"{path.parent}: cannot be read ({error.strerror}); check the path"
        ) from None
    for stem in (path.stem, path.stem.partition("_")[0]):
        for candidate in beside:
            if candidate.stem.lower() == stem.lower():
                return candidate
    if len(beside) == 1:
        return beside[0]
    found = f"{len(beside)} .asf files, none of its name" if beside else "no .asf file"
    raise CharacterError(
        f"{path}: an .amc needs its skeleton, and beside it there is {found}; give skeleton="
    )


@dataclass(frozen=True)
class _Header:
    """What stands above the first frame."""

    radians: float
    rate: float
    lines: int
    """How many lines it has."""
    characters: int
    """How long it is."""


def _header(path: Path, text: str, radians: float) -> _Header:
    """Read the lines before the first frame; angles are as in the .asf if they do not say."""
    rate, start, line = _RATE, 0, 0
    while start < len(text):
        end = text.find("\n", start)
        end = len(text) if end < 0 else end
        words = text[start:end].partition("#")[0].split()
        if words and not words[0].startswith(":"):
            return _Header(radians, rate, line, start)
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
    number: int
    rows: dict[str, tuple[int, list[str]]]
    """Every bone's line and numbers."""


def _frames(path: Path, text: str, header: _Header) -> Iterator[_Frame]:
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


def _values(
    path: Path, text: str, header: _Header, body: asf.Acclaim
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
    path: Path, text: str, header: _Header, body: asf.Acclaim, first: _Frame
) -> tuple[Array, Array]:
    """Return frame numbers and values of frames that list bones in any order."""
    columns = body.columns
    counts, rows = [], []
    for frame in _frames(path, text, header):
        counts.append(float(frame.number))
        rows.append(_row(path, body, columns, frame, first))
    return np.array(counts), np.array(rows)


def _row(
    path: Path, body: asf.Acclaim, columns: dict[str, slice], frame: _Frame, first: _Frame
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
