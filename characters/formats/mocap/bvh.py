"""Biovision hierarchies (.bvh): a skeleton and a motion in one text file.

Source of the format: Meredith and Maddock, "Motion capture file formats explained", University
of Sheffield, 2001. Where files differ, this follows the usual practice of exporters: a joint's
position channels replace its offset, as they do for the root.
"""

from dataclasses import dataclass, field
from itertools import chain
from pathlib import Path

import numpy as np

from cubeling.characters.errors import CharacterError
from cubeling.characters.formats.loading import MotionOptions, RecordedMotion
from cubeling.characters.formats.mocap.axes_and_units import metric_motion
from cubeling.characters.formats.mocap.channels import AxisChannel, ChannelLayout
from cubeling.characters.formats.mocap.text import CUT_OFF, TextFile, numbers, parse_numbers, quote
from cubeling.characters.motion.clip import Clip
from cubeling.characters.skeleton import rotations
from cubeling.characters.skeleton.pose import Array, Pose, Skeleton

_FRAME_TIME_RANGE_S = (1e-5, 1.0)
_STATED_RATES_HZ = (5.0, 1000.0)
"""Numbers that some exporters write as the frame time although they mean frames a second."""


def load_motion(path: Path, options: MotionOptions) -> RecordedMotion:
    """Read a .bvh file; errors name the line of the problem.

    Every joint's rest rotation is the identity. End sites become joints with the name of the
    joint that they end: ``LeftToe_end``. The facing direction stays as it is.
    """
    file = TextFile.read(path)
    tree, end = _read_hierarchy(file)
    rate, values, notes = _motion(file, end, tree.channel_count, options.rate)
    file.check_size(len(tree.names), len(values))
    clip = Clip(path.stem, rate, tree.channels().poses(values), loop=False)
    return metric_motion(path, clip, tree.skeleton(), options, tree.notes() + notes)


@dataclass
class _Tree:
    """The joints read so far."""

    names: list[str] = field(default_factory=list)
    parents: list[int] = field(default_factory=list)
    offsets: list[Array] = field(default_factory=list)
    rotations: list[AxisChannel] = field(default_factory=list)
    translations: list[AxisChannel] = field(default_factory=list)
    name_counts: dict[str, int] = field(default_factory=dict)

    @property
    def channel_count(self) -> int:
        """Numbers in a frame."""
        return len(self.rotations) + len(self.translations)

    def add(self, name: str, parent: int, offset: Array) -> int:
        """Add a joint under a unique name; return its number."""
        unique = name
        while (count := self.name_counts.get(unique, 0)) > 0:
            self.name_counts[unique] = count + 1
            unique = f"{unique}_{count + 1}"
        self.name_counts[unique] = 1
        self.names.append(unique)
        self.parents.append(parent)
        self.offsets.append(offset)
        return len(self.names) - 1

    def skeleton(self) -> Skeleton:
        """Return the skeleton in the file's axes and units."""
        unrotated = np.tile(rotations.IDENTITY, (len(self.names), 1))
        rest = Pose(np.array(self.offsets), unrotated)
        return Skeleton(tuple(self.names), tuple(self.parents), rest)

    def channels(self) -> ChannelLayout:
        """Return how the numbers of a frame move the joints."""
        offsets = np.array(self.offsets)
        for channel in self.translations:
            offsets[channel.joint, channel.axis > 0] = 0.0
        turning, moving = tuple(self.rotations), tuple(self.translations)
        return ChannelLayout(offsets, turning, moving, angle_unit=float(np.pi / 180))

    def notes(self) -> tuple[str, ...]:
        """Return what had to be repaired, one sentence each."""
        repeated = [name for name, count in self.name_counts.items() if count > 1]
        if not repeated:
            return ()
        return (f"{len(repeated)} joint names, as {repeated[0]}, repeat: they are numbered",)


class _Words:
    """The words of a file one by one, each with its line."""

    def __init__(self, file: TextFile) -> None:
        self.file, self.line = file, 1
        self._warned: set[str] = set()
        self._words = (
            (number, word)
            for number, text in enumerate(file.text.split("\n"), start=1)
            for word in text.replace("{", " { ").replace("}", " } ").split()
        )

    def error(self, problem: str, advice: str) -> CharacterError:
        """Return the error for the current line."""
        return self.file.error(self.line, problem, advice)

    def warn_once(self, repair: str) -> None:
        """Warn of a repair the first time that it is made."""
        if repair not in self._warned:
            self._warned.add(repair)
            self.file.warn(repair)

    def next(self, expected: str) -> str:
        """Return the next word; `expected` describes it in the message if there is none."""
        word = next(self._words, None)
        if word is None:
            raise self.error(f"ends where {expected} is expected", CUT_OFF)
        self.line = word[0]
        return word[1]

    def expect(self, *words: str) -> str:
        """Return the next word in capitals, or refuse it if it is not one of these."""
        expected = " or ".join(words)
        word = self.next(expected)
        if word.upper() not in words:
            raise self.error(f"expected {expected}, found {quote(word)}", "export again")
        return word.upper()


def _read_hierarchy(file: TextFile) -> tuple[_Tree, int]:
    """Return the joints, which may have several roots, and the line of MOTION, from 1."""
    words, tree = _Words(file), _Tree()
    words.expect("HIERARCHY")
    words.expect("ROOT")
    roots: list[int] = []
    while True:
        roots.append(len(tree.names))
        _read_joint(words, tree, "ROOT")
        if words.expect("ROOT", "MOTION") == "MOTION":
            break
    if len(roots) > 1:
        names = ", ".join(quote(tree.names[root]) for root in roots[:4])
        file.warn(f"{len(roots)} roots ({names}); the performer is the first")
    if not tree.channel_count:
        raise words.error("no joint has channels", "export the joints with their channels")
    return tree, words.line


def _read_joint(words: _Words, tree: _Tree, kind: str) -> None:
    """Read a joint whose keyword has been read, and all joints below it."""
    open_joints = [_open_joint(words, tree, -1, kind)]
    while open_joints:
        word = words.expect("JOINT", "END", "CHANNELS", "}")
        joint = open_joints[-1]
        if word == "}":
            open_joints.pop()
        elif word == "CHANNELS":
            _read_channels(words, tree, joint)
        elif word == "JOINT":
            open_joints.append(_open_joint(words, tree, joint, word))
        else:
            _skip_site_name(words)
            tree.add(tree.names[joint] + "_end", joint, _offset(words))
            words.expect("}")


def _skip_site_name(words: _Words) -> None:
    """Read `Site {`; some exporters give the site a name, as in `Site_Head {`."""
    name = []
    while (word := words.next("Site and {")) != "{":
        name.append(word)
    stated = " ".join(name)
    if not stated.upper().startswith("SITE") or len(name) > 4:
        raise words.error(f"expected SITE, found {quote(stated or '{')}", "export again")
    if stated.upper() != "SITE":
        words.warn_once("end sites have names; they are called as the joint that they end")


def _open_joint(words: _Words, tree: _Tree, parent: int, kind: str) -> int:
    """Read name, brace and offset of a joint; names may contain spaces."""
    name: list[str] = []
    while (word := words.next("the name of a joint and {")) != "{":
        name.append(word)
    if not name or "}" in name:
        raise words.error(f"this {kind} has no name", "name it")
    return tree.add(" ".join(name), parent, _offset(words))


def _offset(words: _Words) -> Array:
    words.expect("OFFSET")
    numbers = [words.next("three numbers") for _ in range(3)]
    return words.file.vector(words.line, numbers, "OFFSET")


def _read_channels(words: _Words, tree: _Tree, joint: int) -> None:
    """Read which numbers move a joint, in their order in a frame."""
    count = words.next("a number of channels")
    # isdecimal() also accepts digits of other scripts, which int() reads as well.
    if not count.isdecimal() or len(count) > 6:
        raise words.error(f"{quote(count)} is not a number of channels", "give their count")
    for _ in range(int(count)):
        channel = words.next("the name of a channel")
        axis, kind = "XYZ".find(channel[0].upper()), channel[1:].lower()
        if axis < 0 or kind not in ("position", "rotation"):
            raise words.error(
                f"expected a channel of {quote(tree.names[joint])}, found {quote(channel)}",
                "use Xposition … Zrotation, as many as stated",
            )
        moves = AxisChannel(joint, np.eye(3)[axis], tree.channel_count)
        (tree.rotations if kind == "rotation" else tree.translations).append(moves)


def _motion(
    file: TextFile, start: int, width: int, stated_rate: float | None
) -> tuple[float, Array, tuple[str, ...]]:
    """Return rate [Hz], values (frames, width) and notes of the MOTION that follows a line."""
    lines = file.text.split("\n")
    at, stated = _setting(file, lines, start, "frames")
    at, frame_time = _setting(file, lines, at, "frame time")
    rate = _rate(file, at, frame_time) if stated_rate is None else file.checked_rate(stated_rate)
    rows, row_lines = _rows(file, lines, at, width)
    if not rows:
        raise file.error(at, "no frames follow", "export the motion, not the skeleton alone")
    if len(rows) < stated:
        file.warn(f"it has {len(rows)} of the {stated:.0f} frames that it states; they are read")
    values = parse_numbers(chain.from_iterable(rows))
    if values is None:  # the first invalid number raises
        read = zip(row_lines, rows, strict=True)
        values = np.array([[file.number(line, word) for word in row] for line, row in read])
    notes: tuple[str, ...] = ()
    if len(rows) > stated:
        notes = (f"{len(rows)} frames found, {stated:.0f} stated: all are read",)
    return rate, values.reshape(-1, width), notes


def _rate(file: TextFile, line: int, frame_time: float) -> float:
    """Return the frames a second that a frame time [s] stands for."""
    shortest, longest = _FRAME_TIME_RANGE_S
    slowest, fastest = _STATED_RATES_HZ
    if shortest <= frame_time <= longest:
        return _nominal_rate(1.0 / frame_time)
    if slowest <= frame_time <= fastest:
        file.warn(
            f"a frame time of {frame_time:g} s; taken as {frame_time:g} frames a second, "
            "--fps states another rate"
        )
        return frame_time
    problem = f"an invalid frame time of {frame_time:g} s"
    raise file.error(line, problem, "write seconds a frame, or state the rate with --fps")


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
            problem = f"frame {len(rows) + 1} has {numbers(len(row))}, not {width}"
            raise file.error(line + 1, problem, "the file is cut off or edited: export it again")
    return rows, row_lines


def _setting(file: TextFile, lines: list[str], start: int, key: str) -> tuple[int, float]:
    """Return the number of the line `key: value`, from 1, and the value."""
    for line in range(start, len(lines)):
        words = lines[line].replace(":", " ").split()
        if not words:
            continue
        if [word.lower() for word in words[:-1]] != key.split():
            problem = f"expected {key!r}, found {quote(lines[line].strip())}"
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
