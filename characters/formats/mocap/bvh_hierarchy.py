"""The first half of a .bvh file: joints, where they sit, and which numbers move them."""

from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from characters.formats.mocap.channels import Channels, Slide, Turn
from characters.formats.mocap.text import refuse, shown, vector
from characters.skeleton import rotations
from characters.skeleton.pose import Array, Pose, Skeleton

_AXES = np.eye(3)


@dataclass(frozen=True)
class Hierarchy:
    """What stands above the motion of a .bvh file."""

    skeleton: Skeleton
    """In the file's axes and units."""

    channels: Channels
    """How the numbers of a frame move its joints."""

    numbers: int
    """How many numbers a frame has."""

    end: int
    """The line of MOTION, from 1: the one after it is lines[end]."""

    notes: tuple[str, ...]
    """What was repaired."""


@dataclass
class _Words:
    """The words of a text one by one, each with its line."""

    path: Path
    lines: list[str]
    line: int = 1
    _words: Iterator[tuple[int, str]] = field(init=False)

    def __post_init__(self) -> None:
        self._words = (
            (number, word)
            for number, text in enumerate(self.lines, start=1)
            for word in text.replace("{", " { ").replace("}", " } ").split()
        )

    def next(self, wanted: str) -> str:
        """Return the next word; `wanted` says what for, should there be none."""
        word = next(self._words, None)
        if word is None:
            raise refuse(
                self.path,
                self.line,
                f"ends where {wanted} should follow",
                "the file is cut off: export it again",
            )
        self.line = word[0]
        return word[1]

    def expect(self, *words: str) -> str:
        """Return the next word in capitals, or refuse it if it is not one of these."""
        wanted = " or ".join(words)
        word = self.next(wanted)
        if word.upper() not in words:
            raise refuse(
                self.path, self.line, f"{shown(word)} stands where {wanted} should", "export again"
            )
        return word.upper()


@dataclass
class _Tree:
    """What has been read so far."""

    names: list[str] = field(default_factory=list)
    parents: list[int] = field(default_factory=list)
    offsets: list[Array] = field(default_factory=list)
    places: list[Array] = field(default_factory=list)
    turns: list[Turn] = field(default_factory=list)
    slides: list[Slide] = field(default_factory=list)
    numbers: int = 0
    namesakes: dict[str, int] = field(default_factory=dict)

    def add(self, name: str, parent: int, offset: Array) -> int:
        """Add a joint under a name that no other has; return its number."""
        unique = name
        while (count := self.namesakes.get(unique, 0)) > 0:
            self.namesakes[unique] = count + 1
            unique = f"{unique}_{count + 1}"
        self.namesakes[unique] = 1
        self.names.append(unique)
        self.parents.append(parent)
        self.offsets.append(offset)
        self.places.append(offset.copy())
        return len(self.names) - 1


def read_hierarchy(path: Path, lines: list[str]) -> Hierarchy:
    """Read the joints of a .bvh file, several roots included.

    Raises
    ------
    CharacterError
        If they cannot be read, with the line that is at fault.
    """
    words, tree = _Words(path, lines), _Tree()
    words.expect("HIERARCHY")
    words.expect("ROOT")
    while True:
        _read_joint(words, tree, "ROOT")
        if words.expect("ROOT", "MOTION") == "MOTION":
            break
    if not tree.numbers:
        raise refuse(path, words.line, "no joint has channels", "export the joints with theirs")
    offsets = np.array(tree.offsets)
    still = np.tile(rotations.IDENTITY, (len(offsets), 1))
    skeleton = Skeleton(tuple(tree.names), tuple(tree.parents), Pose(offsets, still))
    channels = Channels(
        np.array(tree.places), tuple(tree.turns), tuple(tree.slides), float(np.pi / 180)
    )
    shared = [name for name, count in tree.namesakes.items() if count > 1]
    notes: tuple[str, ...] = ()
    if shared:
        notes = (f"{len(shared)} names, as {shared[0]}, are of several joints: now of one each",)
    return Hierarchy(skeleton, channels, tree.numbers, words.line, notes)


def _read_joint(words: _Words, tree: _Tree, kind: str) -> None:
    """Read a joint whose keyword has been read, and everything under it."""
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
    """Read name, brace and offset of a joint; names may have spaces in them."""
    name: list[str] = []
    while (word := words.next("the name of a joint and {")) != "{":
        name.append(word)
    if not name or "}" in name:
        raise refuse(words.path, words.line, f"this {kind} has no name", "name it")
    return tree.add(" ".join(name), parent, _offset(words))


def _offset(words: _Words) -> Array:
    words.expect("OFFSET")
    numbers = [words.next("three numbers") for _ in range(3)]
    return vector(words.path, words.line, numbers, "OFFSET")


def _read_channels(words: _Words, tree: _Tree, joint: int) -> None:
    """Read which numbers move a joint, in the order in which they stand in a frame."""
    count = words.next("a number of channels")
    # isdecimal() also takes other scripts' digits, which int() reads as well.
    if not count.isdecimal() or len(count) > 6:
        raise refuse(words.path, words.line, f"{shown(count)} channels is none", "give their count")
    for _ in range(int(count)):
        channel = words.next("the name of a channel")
        axis, what = "XYZ".find(channel[0].upper()), channel[1:].lower()
        if axis < 0 or what not in ("position", "rotation"):
            raise refuse(
                words.path,
                words.line,
                f"{shown(channel)} stands where the {count} channels of "
                f"{shown(tree.names[joint])} should",
                "use Xposition … Zrotation, as many as stated",
            )
        if what == "rotation":
            tree.turns.append(Turn(joint, _AXES[axis], tree.numbers))
        else:
            tree.places[joint][axis] = 0.0
            tree.slides.append(Slide(joint, _AXES[axis], tree.numbers))
        tree.numbers += 1
