"""Biovision hierarchies (.bvh): a skeleton and a motion in one text file.

Source of the format: Meredith and Maddock, "Motion capture file formats explained", University
of Sheffield, 2001. Where files differ, this follows the usual practice of exporters: a joint's
position channels replace its offset, as they do for the root.
"""

from itertools import chain
from pathlib import Path

from characters.formats.loading import MotionOptions, Performance
from characters.formats.mocap.axes_and_units import metric_performance
from characters.formats.mocap.bvh_hierarchy import read_hierarchy
from characters.formats.mocap.text import CUT_OFF, TextFile, parse_numbers, quoted
from characters.motion.clip import Clip
from characters.skeleton.pose import Array

_FRAME_TIME_RANGE_S = (1e-5, 100.0)


def load_motion(path: Path, options: MotionOptions) -> Performance:
    """Read a .bvh file.

    Every joint's rest rotation is the identity. End sites become joints with the name of the
    joint that they end: ``LeftToe_end``. The facing direction stays as it is.

    Raises
    ------
    CharacterError
        If the file cannot be read, with the line of the problem.
    """
    file = TextFile.read(path)
    hierarchy = read_hierarchy(file)
    rate, values, notes = _motion(file, hierarchy.end, hierarchy.channel_count)
    file.check_size(len(hierarchy.skeleton), len(values))
    poses = hierarchy.channels.poses(values)
    clip = Clip(path.stem, rate, poses, loop=False)
    return metric_performance(path, clip, hierarchy.skeleton, options, hierarchy.notes + notes)


def _motion(file: TextFile, start: int, width: int) -> tuple[float, Array, tuple[str, ...]]:
    """Return rate [Hz], values (frames, width) and notes of the MOTION that follows a line."""
    lines = file.text.split("\n")
    at, stated = _setting(file, lines, start, "frames")
    at, frame_time = _setting(file, lines, at, "frame time")
    shortest, longest = _FRAME_TIME_RANGE_S
    if not shortest <= frame_time <= longest:
        raise file.error(at, f"an invalid frame time of {frame_time:g} s", "state seconds a frame")
    rows, row_lines = _rows(file, lines, at, width)
    if not rows:
        raise file.error(at, "no frames follow", "export the motion, not the skeleton alone")
    if len(rows) < stated:
        problem = f"ends after {len(rows)} of {stated:.0f} frames"
        raise file.error(row_lines[-1], problem, CUT_OFF)
    values = parse_numbers(chain.from_iterable(rows))
    if values is None:  # the first invalid number raises
        for line, row in zip(row_lines, rows, strict=True):
            for word in row:
                file.number(line, word)
        raise AssertionError("parse_numbers refused valid numbers")
    notes: tuple[str, ...] = ()
    if len(rows) > stated:
        notes = (f"{stated:.0f} frames stated, {len(rows)} found: all are read",)
    return _nominal_rate(1.0 / frame_time), values.reshape(-1, width), notes


def _rows(
    file: TextFile, lines: list[str], start: int, width: int
) -> tuple[list[list[str]], list[int]]:
    """Return the words of every frame after a line, and the lines of the frames."""
    rows, row_lines = [], []
    for line in range(start, len(lines)):
        row = lines[line].split()
        if len(row) == width and row:
            rows.append(row)
            row_lines.append(line + 1)
        elif row:
            problem = f"frame {len(rows) + 1} has {len(row)} numbers for {width} channels"
            raise file.error(line + 1, problem, "the file is cut off or edited: export it again")
    return rows, row_lines


def _setting(file: TextFile, lines: list[str], start: int, key: str) -> tuple[int, float]:
    """Return the number of the line `key: value`, from 1, and the value."""
    for line in range(start, len(lines)):
        words = lines[line].replace(":", " ").split()
        if not words:
            continue
        if [word.lower() for word in words[:-1]] != key.split():
            problem = f"expected {key!r}, found {quoted(lines[line].strip())}"
            raise file.error(line + 1, problem, "export it again")
        return line + 1, file.number(line + 1, words[-1])
    raise file.error(len(lines), f"ends without {key!r}", CUT_OFF)


def _nominal_rate(rate: float) -> float:
    """Return the whole rate that a rounded frame time, as 0.0083333 s, stands for.

    >>> _nominal_rate(1 / 0.0083333), round(_nominal_rate(1 / 0.008342), 3)
    (120.0, 119.875)
    """
    whole = float(round(rate))
    return whole if abs(rate - whole) < 1e-4 * rate else rate
