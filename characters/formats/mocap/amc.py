"""Acclaim motions (.amc): how the bones of an .asf move, frame by frame."""

import re
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import compress, cycle
from pathlib import Path

import numpy as np

from characters.errors import CharacterError
from characters.formats.loading import MotionOptions, Performance
from characters.formats.mocap.asf import AcclaimSkeleton, load_skeleton
from characters.formats.mocap.axes_and_units import metric_performance
from characters.formats.mocap.text import CUT_OFF, TextFile, parse_numbers, quoted
from characters.motion.clip import Clip
from characters.skeleton.pose import Array

BLOCK_CHARACTERS = 1 << 22
"""Length of text that is split into words at once."""

_CMU_RATE_HZ = 120.0  # where files state none
_MAX_RATE_HZ = 1e5
_FRAME_NUMBER = re.compile(r"\n[ \t]*\d{1,11}[ \t]*\n")


def load_motion(path: Path, options: MotionOptions) -> Performance:
    """Read an .amc file and the .asf that goes with it.

    Every joint's rest rotation is the identity: joints keep the axes of the file, and the bones'
    own frames become part of the motion. Joints have the names of the bones, the hips are "root";
    the ends of last bones are joints too, such as ``ltoes_end``.

    The .asf left out is the one in the same folder with the motion's name or the first part of it
    (16_08.amc: 16.asf), or the only one there. The rate left out is the one in the file, or 120 Hz.
    The scale left out is the stated unit if it makes a performer of 0.5 to 2.5 m, else it is
    recognised by size.

    Raises
    ------
    CharacterError
        If one of the files is absent or cannot be read, with the line of the problem.
    """
    file = TextFile.read(path)
    body = load_skeleton(options.skeleton or find_skeleton(path))
    header = _header(file, body.angle_unit)
    rate = options.rate if options.rate is not None else header.rate
    if not 0 < rate < _MAX_RATE_HZ:
        raise CharacterError(f"{path}: invalid rate of {rate:g} frames a second; give rate= in Hz")
    values, notes = _values(file, header, body)
    file.check_size(len(body.skeleton), len(values))
    poses = body.channels(header.angle_unit).poses(values)
    clip = Clip(path.stem, rate, poses, loop=False)
    return metric_performance(path, clip, body.skeleton, options, notes, stated_unit=body.unit)


def find_skeleton(path: Path) -> Path:
    """Return the .asf in the folder of an .amc.

    Raises
    ------
    CharacterError
        If there is none, or if there are several and none has the name of the motion.
    """
    try:
        candidates = sorted(p for p in path.parent.iterdir() if p.suffix.lower() == ".asf")
    except OSError as error:
        raise CharacterError(
            f"{path.parent}: cannot be read ({error.strerror}); check the path"
        ) from None
    for stem in (path.stem, path.stem.partition("_")[0]):
        for candidate in candidates:
            if candidate.stem.lower() == stem.lower():
                return candidate
    if len(candidates) == 1:
        return candidates[0]
    found = f"{len(candidates)} .asf files, none of its name" if candidates else "no .asf file"
    raise CharacterError(
        f"{path}: an .amc needs its skeleton, and its folder has {found}; "
        "name it: --skeleton, or skeleton= in Python"
    )


@dataclass(frozen=True)
class _Header:
    """The lines before the first frame."""

    angle_unit: float
    """Size of an angle of 1 [rad]."""

    rate: float
    """Frame rate [Hz]."""

    lines: int
    """Number of lines."""

    characters: int
    """Number of characters: the first frame starts there."""


def _header(file: TextFile, angle_unit: float) -> _Header:
    """Read the lines before the first frame; angles are as in the .asf if they do not say."""
    text, rate, start, line = file.text, _CMU_RATE_HZ, 0, 0
    while start < len(text):
        end = text.find("\n", start)
        end = len(text) if end < 0 else end
        words = text[start:end].partition("#")[0].split()
        if words and not words[0].startswith(":"):
            return _Header(angle_unit, rate, line, start)
        line += 1
        start = end + 1
        key = words[0].upper() if words else ""
        if key in (":DEGREES", ":RADIANS"):
            angle_unit = 1.0 if key == ":RADIANS" else float(np.pi / 180)
        elif key == ":SAMPLES-PER-SECOND" and len(words) > 1:
            rate = file.number(line, words[1])
    raise CharacterError(f"{file.path}: has no frames; is this a whole .amc?")


@dataclass(frozen=True)
class _Frame:
    """The words of one frame."""

    line: int
    """The line of its number, from 1."""

    number: int
    """As in the file."""

    rows: dict[str, tuple[int, list[str]]]
    """Line and numbers by bone."""


def _values(
    file: TextFile, header: _Header, body: AcclaimSkeleton
) -> tuple[Array, tuple[str, ...]]:
    """Return the numbers of all frames, (frames, numbers of a frame), and notes."""
    text, columns = file.text, body.columns
    blocks = list(_blocks(text, header.characters))
    first = next(_frames(file, blocks[0], header.lines))
    _row(file, body, columns, first, first)
    tables: list[Array] = []
    for block in blocks:
        table = _uniform_table(text[slice(*block)], columns, first)
        if table is None:  # frames list different bones, or one is invalid
            line = text.count("\n", 0, block[0])
            frames = _frames(file, block, line)
            table = np.array([_row(file, body, columns, frame, first) for frame in frames])
        tables.append(table)
    table = np.concatenate(tables)
    notes = [
        f"{bone.name} does not move: the .amc does not mention it"
        for bone in body.bones
        if bone.dof and bone.name not in first.rows
    ]
    if (np.diff(table[:, 0]) != 1).any():
        notes.append("the frame numbers have gaps; frames are read as consecutive")
    return table[:, 1:], tuple(notes)


def _blocks(text: str, start: int) -> Iterator[tuple[int, int]]:
    """Yield the start and end of blocks of whole frames in a text."""
    while start < len(text):
        found = _FRAME_NUMBER.search(text, start + BLOCK_CHARACTERS)
        end = found.start() + 1 if found else len(text)
        yield start, end
        start = end


def _frames(file: TextFile, block: tuple[int, int], lines: int) -> Iterator[_Frame]:
    """Yield the frames of a block that begins after so many lines; refuse invalid lines."""
    frame: _Frame | None = None
    for line, content in enumerate(file.text[slice(*block)].split("\n"), start=lines + 1):
        words = content.partition("#")[0].split()
        if not words:
            continue
        if len(words) == 1 and words[0].isdecimal() and len(words[0]) < 12:
            if frame is not None:
                yield frame
            frame = _Frame(line, int(words[0]), {})
        elif frame is None:
            problem = f"{quoted(words[0])} before the number of the first frame"
            raise file.error(line, problem, "is this an .amc?")
        elif words[0] in frame.rows:
            problem = f"frame {frame.number} moves {quoted(words[0])} twice"
            raise file.error(line, problem, "a frame number is missing: export it again")
        else:
            frame.rows[words[0]] = (line, words[1:])
    if frame is not None:
        yield frame


def _uniform_table(text: str, columns: dict[str, slice], first: _Frame) -> Array | None:
    """Return the table of a block whose frames list the bones in the order of the first frame.

    A row of the table is a frame's number and its values. The text is split into words and not
    into lines, which makes this fast. None if a frame differs.
    """
    names = {}  # bone names by position in a frame
    order = [0]  # column of the table for each number of a frame
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
    found = parse_numbers(compress(tokens, cycle(mask)))
    if found is None:
        return None
    table = np.zeros((frames, 1 + _width(columns)))
    table[:, order] = found.reshape(frames, len(order))
    return table


def _width(columns: dict[str, slice]) -> int:
    """Return the number of values of a frame."""
    return max(int(part.stop) for part in columns.values())


def _row(
    file: TextFile,
    body: AcclaimSkeleton,
    columns: dict[str, slice],
    frame: _Frame,
    first: _Frame,
) -> Array:
    """Return the number and the values of a frame in the skeleton's order, or refuse it."""
    row = np.zeros(_width(columns))
    for name, (line, words) in frame.rows.items():
        if name not in columns:
            problem = f"{body.path.name} has no bone {quoted(name)}"
            raise file.error(line, problem, "give the .asf of the same performer with skeleton=")
        part = columns[name]
        if len(words) != part.stop - part.start:
            problem = (
                f"{quoted(name)} has {len(words)} numbers, but {part.stop - part.start} degrees "
                f"of freedom in {body.path.name}"
            )
            raise file.error(line, problem, "give the .asf of the same performer, or export again")
        row[part] = [file.number(line, word) for word in words]
    missing = [name for name in first.rows if name not in frame.rows]
    if missing or not frame.rows:
        absent = quoted(missing[0]) if missing else "all bones"
        raise file.error(frame.line, f"frame {frame.number} lacks {absent}", CUT_OFF)
    return np.concatenate([[frame.number], row])
