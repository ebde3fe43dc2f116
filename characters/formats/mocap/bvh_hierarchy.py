"""The HIERARCHY of a .bvh file: joints, offsets and channels."""

from collections.abc import Iterator
from dataclasses import dataclass, field

import numpy as np

from characters.errors import CharacterError
from characters.formats.mocap.channels import AxisChannel, ChannelLayout
from characters.formats.mocap.text import CUT_OFF, TextFile, quoted
from characters.skeleton import rotations
from characters.skeleton.pose import Array, Pose, Skeleton

_AXES = np.eye(3)


@dataclass(frozen=True)
class Hierarchy:
    """What a .bvh file says before its motion."""

    skeleton: Skeleton
    """In the file's axes and units."""

    channels: ChannelLayout
    """How the numbers of a frame move its joints."""

    channel_count: int
    """Numbers in a frame."""

    end: int
    """The line of MOTION, from 1: the one after it is lines[end]."""

    notes: tuple[str, ...]
    """Repairs."""


@dataclass
class _Words:
    """The words of a file one by one, each with its line."""

    file: TextFile
    line: int = 1
    _words: Iterator[tuple[int, str]] = field(init=False)

    def __post_init__(self) -> None:
        self._words = (
            (number, word)
            for number, text in enumerate(self.file.text.split("\n"), start=1)
            for word in text.replace("{", " { ").replace("}", " } ").split()
        )

    def error(self, problem: str, advice: str) -> CharacterError:
        """Return the error for the current line."""
        return self.file.error(self.line, problem, advice)

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
            raise self.error(f"expected {expected}, found {quoted(word)}", "export again")
        return word.upper()


@dataclass
class _Tree:
    """The joints read so far."""

    names: list[str] = field(default_factory=list)
    parents: list[int] = field(default_factory=list)
    offsets: list[Array] = field(default_factory=list)
    static_offsets: list[Array] = field(default_factory=list)
    """Offsets without the components that position channels replace."""

    rotations: list[AxisChannel] = field(default_factory=list)
    translations: list[AxisChannel] = field(default_factory=list)
    channel_count: int = 0
    name_counts: dict[str, int] = field(default_factory=dict)

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
        self.static_offsets.append(offset.copy())
        return len(self.names) - 1


def read_hierarchy(file: TextFile) -> Hierarchy:
    """Read the joints of a .bvh file, which may have several roots.

    Raises
    ------
    CharacterError
        If they cannot be read, with the line of the problem.
    """
    words, tree = _Words(file), _Tree()
    words.expect("HIERARCHY")
    words.expect("ROOT")
    while True:
        _read_joint(words, tree, "ROOT")
        if words.expect("ROOT", "MOTION") == "MOTION":
            break
    if not tree.channel_count:
        raise words.error("no joint has channels", "export the joints with their channels")
    offsets = np.array(tree.offsets)
    unrotated = np.tile(rotations.IDENTITY, (len(offsets), 1))
    channels = ChannelLayout(
        np.array(tree.static_offsets),
        tuple(tree.rotations),
        tuple(tree.translations),
        angle_unit=float(np.pi / 180),
    )
    repeated = [name for name, count in tree.name_counts.items() if count > 1]
    notes: tuple[str, ...] = ()
    if repeated:
        notes = (f"{len(repeated)} joint names, as {repeated[0]}, repeat: they are numbered",)
    return Hierarchy(
        Skeleton(tuple(tree.names), tuple(tree.parents), Pose(offsets, unrotated)),
        channels,
        tree.channel_count,
        words.line,
        notes,
    )


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
            words.expect("SITE")
            words.expect("{")
            tree.add(tree.names[joint] + "_end", joint, _offset(words))
            words.expect("}")


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
        raise words.error(f"{quoted(count)} is not a number of channels", "give their count")
    for _ in range(int(count)):
        channel = words.next("the name of a channel")
        axis, kind = "XYZ".find(channel[0].upper()), channel[1:].lower()
        if axis < 0 or kind not in ("position", "rotation"):
            raise words.error(
                f"expected {count} channels of {quoted(tree.names[joint])}, found "
                f"{quoted(channel)}",
                "use Xposition … Zrotation, as many as stated",
            )
        moves = AxisChannel(joint, _AXES[axis], tree.channel_count)
        if kind == "rotation":
            tree.rotations.append(moves)
        else:
            tree.static_offsets[joint][axis] = 0.0
            tree.translations.append(moves)
        tree.channel_count += 1
