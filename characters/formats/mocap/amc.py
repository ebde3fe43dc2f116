"""Acclaim motions (.amc): how the bones of an .asf move, frame by frame."""

import re
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import compress, cycle
from pathlib import Path

import numpy as np

from cubeling.characters.errors import CharacterError
from cubeling.characters.formats.loading import MotionOptions, RecordedMotion
from cubeling.characters.formats.mocap.asf import AcclaimSkeleton, load_skeleton
from cubeling.characters.formats.mocap.axes_and_units import metric_motion
from cubeling.characters.formats.mocap.text import CUT_OFF, TextFile, numbers, parse_numbers, quote
from cubeling.characters.motion.clip import Clip
from cubeling.characters.skeleton.pose import Array

BLOCK_CHARACTERS = 1 << 22
"""Length of text that is split into words at once."""

_CMU_RATE_HZ = 120.0  # where files state none
_FRAME_NUMBER = re.compile(r"\n[ \t]*\d{1,11}[ \t]*\n")


def load_motion(path: Path, options: MotionOptions) -> RecordedMotion:
    """Read an .amc file and the .asf that goes with it; errors name the line of the problem.

    Every joint's rest rotation is the identity: joints keep the axes of the file, and the bones'
    own frames become part of the motion. Joints have the names of the bones, the hips are "root";
    the ends of last bones are joints too, such as ``ltoes_end``.

    The .asf left out is the one in the same folder with the motion's name or the first part of it
    (16_08.amc: 16.asf), or the only one there. The scale left out is the stated unit if it makes a
    performer of 0.5 to 2.5 m, else it is recognised by size.
    """
    file = TextFile.read(path)
    body = load_skeleton(options.skeleton or _find_skeleton(path))
    angle_unit, rate, start = _header(file, body.angle_unit)
    rate = file.checked_rate(rate if options.rate is None else options.rate)
    values, notes = _values(file, start, body)
    file.check_size(len(body.skeleton), len(values))
    clip = Clip(path.stem, rate, body.channels(angle_unit).poses(values), loop=False)
    return metric_motion(path, clip, body.skeleton, options, notes, stated_unit=body.unit)


def _find_skeleton(path: Path) -> Path:
    """Return the .asf in the folder of an .amc, or refuse several without its name."""
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


def _header(file: TextFile, angle_unit: float) -> tuple[float, float, int]:
    """Return angle unit [rad], by default that of the .asf, rate [Hz] and start of the frames."""
    rate = _CMU_RATE_HZ
    for number, line in enumerate(re.finditer(r".*\n?", file.text), start=1):
        words = line[0].partition("#")[0].split()
        if not words:
            continue
        if not words[0].startswith(":"):
            return angle_unit, rate, line.start()
        key = words[0].upper()
        if key in (":DEGREES", ":RADIANS"):
            angle_unit = 1.0 if key == ":RADIANS" else float(np.pi / 180)
        elif key == ":SAMPLES-PER-SECOND" and len(words) > 1:
            rate = file.number(number, words[1])
    raise CharacterError(f"{file.path}: has no frames; is this a whole .amc?")


@dataclass(frozen=True)
class _Frame:
    """The words of one frame."""

    line: int  # that of its number, from 1
    number: int  # as in the file
    rows: dict[str, tuple[int, list[str]]]  # line and numbers by bone


def _values(file: TextFile, start: int, body: AcclaimSkeleton) -> tuple[Array, tuple[str, ...]]:
    """Return the numbers of all frames, (frames, numbers of a frame), and notes."""
    blocks = list(_blocks(file.text, start))
    first = next(_frames(file, blocks[0]))
    _row(file, body, first, first)
    tables: list[Array] = []
    for block in blocks:
        table = _uniform_table(file.text[slice(*block)], body, first)
        if table is None:  # frames list different bones, or one is invalid
            table = np.array([_row(file, body, frame, first) for frame in _frames(file, block)])
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


def _frames(file: TextFile, block: tuple[int, int]) -> Iterator[_Frame]:
    """Yield the frames of a block; refuse invalid lines."""
    frame: _Frame | None = None
    first_line = file.text.count("\n", 0, block[0]) + 1
    for line, content in enumerate(file.text[slice(*block)].split("\n"), start=first_line):
        words = content.partition("#")[0].split()
        if not words:
            continue
        if len(words) == 1 and words[0].isdecimal() and len(words[0]) < 12:
            if frame is not None:
                yield frame
            frame = _Frame(line, int(words[0]), {})
        elif frame is None:
            problem = f"{quote(words[0])} before the number of the first frame"
            raise file.error(line, problem, "is this an .amc?")
        elif words[0] in frame.rows:
            problem = f"frame {frame.number} moves {quote(words[0])} twice"
            raise file.error(line, problem, "a frame number is missing: export it again")
        else:
            frame.rows[words[0]] = (line, words[1:])
    if frame is not None:
        yield frame


def _uniform_table(text: str, body: AcclaimSkeleton, first: _Frame) -> Array | None:
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
        order += range(body.columns[name].start + 1, body.columns[name].stop + 1)
    tokens, period = text.split(), len(mask)
    frames = len(tokens) // period
    if frames * period != len(tokens):
        return None
    if any(tokens[at::period] != [name] * frames for at, name in names.items()):
        return None
    found = parse_numbers(compress(tokens, cycle(mask)))
    if found is None:
        return None
    table = np.zeros((frames, 1 + body.width))
    table[:, order] = found.reshape(frames, len(order))
    return table


def _row(file: TextFile, body: AcclaimSkeleton, frame: _Frame, first: _Frame) -> Array:
    """Return the number and the values of a frame in the skeleton's order, or refuse it."""
    row = np.zeros(body.width)
    for name, (line, words) in frame.rows.items():
        if name not in body.columns:
            problem = f"{body.path.name} has no bone {quote(name)}"
            raise file.error(line, problem, "give the .asf of the same performer with skeleton=")
        part = body.columns[name]
        if len(words) != part.stop - part.start:
            problem = (
                f"{quote(name)} has {numbers(len(words))} instead of {part.stop - part.start}, "
                f"its degrees of freedom in {body.path.name}"
            )
            raise file.error(line, problem, "give the .asf of the same performer, or export again")
        row[part] = [file.number(line, word) for word in words]
    missing = [name for name in first.rows if name not in frame.rows]
    if missing or not frame.rows:
        absent = quote(missing[0]) if missing else "all bones"
        raise file.error(frame.line, f"frame {frame.number} lacks {absent}", CUT_OFF)
    return np.concatenate([[frame.number], row])
