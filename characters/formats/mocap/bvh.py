"""Biovision hierarchies (.bvh): a skeleton and a motion in one text file.

Source of the format: Meredith and Maddock, "Motion capture file formats explained", University
of Sheffield, 2001. Where files in the wild differ, the usual practice of exporters is followed:
a joint's position channels replace its offset, as they do for the root.
"""

from pathlib import Path

from characters.formats.mocap.axes_and_units import settle
from characters.formats.mocap.bvh_hierarchy import read_hierarchy
from characters.formats.mocap.text import check_size, number, number_rows, read_text, refuse, shown
from characters.model.performance import Performance
from characters.motion.clip import Clip
from characters.skeleton.pose import Array

_FRAME_TIMES = (1e-5, 100.0)  # [s]


def load(path: "str | Path", *, scale: float | None = None, up: str | None = None) -> Performance:
    """Read a .bvh file.

    Every joint's rest rotation is the identity. End sites become joints, called after the joint
    that they end: ``LeftToe_end``. The facing is left as it is.

    Parameters
    ----------
    path
        The file.
    scale
        Metres a unit. Left out, it is the unit (m, foot, dm, inch, cm, mm) that makes the
        performer most nearly 1.7 m tall, or the one of the CMU database if that makes
        1.2 to 2.0 m; a note says which.
    up
        The axis that points up: "y", "z", "-y", …. Left out, it is the one from feet to head.

    Raises
    ------
    CharacterError
        If the file cannot be read, with the line that is at fault.
    """
    path = Path(path)
    lines = read_text(path).split("\n")
    hierarchy = read_hierarchy(path, lines)
    rate, values, notes = _motion(path, lines, hierarchy.end, hierarchy.numbers)
    check_size(path, len(hierarchy.skeleton), len(values))
    poses = hierarchy.channels.poses(values)
    settled = settle(path, hierarchy.skeleton, poses, scale=scale, up=up)
    clip = Clip(path.stem, rate, settled.poses, loop=False)
    return Performance(settled.skeleton, clip, hierarchy.notes + notes + settled.notes)


def _motion(
    path: Path, lines: list[str], start: int, width: int
) -> tuple[float, Array, tuple[str, ...]]:
    """Return rate [Hz], values (frames, width) and notes of what follows the hierarchy."""
    at, stated = _setting(path, lines, start, "frames")
    at, frame_time = _setting(path, lines, at, "frame time")
    low, high = _FRAME_TIMES
    if not low <= frame_time <= high:
        raise refuse(
            path, at, f"a frame time of {frame_time:g} s is none", "state the seconds a frame"
        )
    rows, where = _rows(path, lines, at, width)
    if not rows:
        raise refuse(path, at, "no frames follow", "export the motion, not the skeleton alone")
    if len(rows) < stated:
        raise refuse(
            path,
            where[-1],
            f"ends after {len(rows)} of {stated:.0f} frames",
            "the file is cut off: export it again",
        )
    values = number_rows(rows)
    if values is None:  # find the first number that is none, which raises
        for line, row in zip(where, rows, strict=True):
            for token in row:
                number(path, line, token)
        raise AssertionError("an unsound number was found, and then it was not")
    notes: tuple[str, ...] = ()
    if len(rows) > stated:
        notes = (f"{stated:.0f} frames stated, {len(rows)} there: all are read",)
    return _usual(1.0 / frame_time), values, notes


def _rows(
    path: Path, lines: list[str], start: int, width: int
) -> tuple[list[list[str]], list[int]]:
    """Return the words of every frame from a line on, and the lines that they stand on."""
    rows, where = [], []
    for line in range(start, len(lines)):
        row = lines[line].split()
        if len(row) == width and row:
            rows.append(row)
            where.append(line + 1)
        elif row:
            raise refuse(
                path,
                line + 1,
                f"frame {len(rows) + 1} has {len(row)} numbers where the joints have {width} "
                "channels",
                "the file is cut off or edited: export it again",
            )
    return rows, where


def _setting(path: Path, lines: list[str], start: int, key: str) -> tuple[int, float]:
    """Return where the line `key: value` ends, and its value; lines count from 1."""
    for line in range(start, len(lines)):
        words = lines[line].replace(":", " ").split()
        if not words:
            continue
        if [word.lower() for word in words[:-1]] != key.split():
            found = shown(lines[line].strip())
            raise refuse(path, line + 1, f"{found} stands where {key!r} should", "export it again")
        return line + 1, number(path, line + 1, words[-1])
    raise refuse(path, len(lines), f"ends without {key!r}", "the file is cut off: export it again")


def _usual(rate: float) -> float:
    """Return a whole rate if a rounded frame time, as 0.0083333 s, means it.

    >>> _usual(1 / 0.0083333), round(_usual(1 / 0.008342), 3)
    (120.0, 119.875)
    """
    whole = float(round(rate))
    return whole if abs(rate - whole) < 1e-4 * rate else rate
