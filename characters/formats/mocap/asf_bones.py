"""Sections, bones and hierarchy of an .asf file."""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import TypeAlias

import numpy as np

from cubeling.characters.errors import CharacterError
from cubeling.characters.formats.mocap.text import CUT_OFF, TextFile, quote
from cubeling.characters.skeleton import rotations
from cubeling.characters.skeleton.pose import Array

_DOFS = ("tx", "ty", "tz", "rx", "ry", "rz", "l")
_ROTATION_ORDERS = ("xyz", "xzy", "yxz", "yzx", "zxy", "zyx")
Line: TypeAlias = tuple[int, list[str]]
"""The number of a line, from 1, and its words: at least one."""


@dataclass(frozen=True)
class AsfBone:
    """A bone, or the root."""

    name: str
    """Name, as in the .amc."""

    direction: Array
    """Unit vector from its start to its end, in the file's axes, (3,)."""

    length: float
    """Length in the file's unit; 0 for the root."""

    axis: Array
    """Angles of its own frame about the axes of `order`, in the file's unit, (3,)."""

    order: str
    """The axes in the order in which they are applied, as "xyz"."""

    dof: tuple[str, ...]
    """What the numbers of a frame move: rx, ry, rz, tx, ty, tz, and l for its length."""

    position: Array
    """Its start when nothing moves, in the file's unit, (3,); zero except for the root."""

    def file_from_bone(self, angle_unit: float) -> Array:
        """Return the rotation from its own frame to the file's axes, (3, 3)."""
        q = rotations.from_euler(self.order[::-1], self.axis[::-1] * angle_unit)
        return rotations.to_matrix(q)


def read_sections(file: TextFile) -> dict[str, list[Line]]:
    """Return the lines of every section `:name`, without comments and empty lines."""
    sections: dict[str, list[Line]] = {}
    current: list[Line] | None = None
    for number, line in enumerate(file.text.split("\n"), start=1):
        words = line.partition("#")[0].split()
        if not words:
            continue
        if words[0].startswith(":"):
            name = words[0][1:].lower()
            if name in sections:
                raise file.error(number, f"a second :{name}", "keep one of them")
            current = sections[name] = []
            if name != "documentation" and words[1:]:
                current.append((number, words[1:]))
        elif current is None:
            raise file.error(number, f"{quote(words[0])} before any section", "is this an .asf?")
        else:
            current.append((number, words))
    return sections


def _blocks(file: TextFile, lines: list[Line]) -> Iterator[tuple[int, list[Line]]]:
    """Yield the lines of every begin … end, and the line of its begin."""
    start = 0
    inside: list[Line] = []
    for number, words in lines:
        word = words[0].lower()
        if word == "begin":
            if start:
                raise file.error(number, "begin inside begin", "an end is missing above")
            start, inside = number, []
        elif word == "end":
            if not start:
                raise file.error(number, "end without begin", "a begin is missing above")
            yield start, inside
            start = 0
        elif start:
            inside.append((number, words))
        else:
            raise file.error(number, f"{quote(words[0])} outside begin … end", "move it inside")
    if start:
        raise file.error(start, "this begin has no end", CUT_OFF)


def read_bones(file: TextFile, sections: dict[str, list[Line]]) -> tuple[list[AsfBone], list[int]]:
    """Return root and bones, parents first, and the number of each one's parent."""
    for name in ("root", "bonedata", "hierarchy"):
        if name not in sections:
            raise CharacterError(f"{file.path}: has no :{name}; is this a whole .asf?")
    root = _root(file, sections["root"])
    bones: dict[str, AsfBone] = {root.name: root}
    for start, lines in _blocks(file, sections["bonedata"]):
        bone = _bone(file, start, lines)
        if bone.name in bones:
            raise file.error(start, f"a second bone {quote(bone.name)}", "rename one of them")
        bones[bone.name] = bone
    children = _children(file, sections["hierarchy"], bones)
    order, parents = [root.name], [-1]
    waiting = [(0, name) for name in reversed(children.get(root.name, []))]
    while waiting:
        parent, name = waiting.pop()
        waiting += [(len(order), child) for child in reversed(children.get(name, []))]
        order.append(name)
        parents.append(parent)
    reached = set(order)
    lost = [name for name in bones if name not in reached]
    if lost:
        raise CharacterError(
            f"{file.path}: bone {quote(lost[0])} is not connected to the root; "
            "name its parent in :hierarchy"
        )
    return [bones[name] for name in order], parents


def _children(file: TextFile, lines: list[Line], bones: dict[str, AsfBone]) -> dict[str, list[str]]:
    """Return every bone's children; every child has one parent."""
    children: dict[str, list[str]] = {}
    placed = {"root"}
    for _, inside in _blocks(file, lines):
        for line, words in inside:
            for word in words:
                if word not in bones:
                    raise file.error(line, f"no bone named {quote(word)}", "add it to :bonedata")
            for child in words[1:]:
                if child in placed:
                    problem = f"{quote(child)} has a parent already"
                    raise file.error(line, problem, "keep one of them")
                placed.add(child)
            children.setdefault(words[0], []).extend(words[1:])
    return children


def _root(file: TextFile, lines: list[Line]) -> AsfBone:
    """Read the root: it starts at `position` and rotates about the axes of `orientation`."""
    up, zero = np.array([0.0, 1.0, 0.0]), np.zeros(3)
    bone = AsfBone("root", up, 0.0, zero, "xyz", ("tx", "ty", "tz", "rx", "ry", "rz"), zero)
    for line, (key, *words) in lines:
        match key.lower():
            case "order":
                bone = replace(bone, dof=_dof(file, line, words))
            case "axis":
                bone = replace(bone, order=_order(file, line, words))
            case "position":
                bone = replace(bone, position=file.vector(line, words, "position"))
            case "orientation":
                bone = replace(bone, axis=file.vector(line, words, "orientation"))
    return bone


def _bone(file: TextFile, start: int, lines: list[Line]) -> AsfBone:
    """Read one bone; its joint limits are not kept: recorded motions stay within them."""
    bone = AsfBone("", np.zeros(3), 0.0, np.zeros(3), "xyz", (), np.zeros(3))
    for line, (key, *words) in lines:
        match key.lower():
            case "name":
                bone = replace(bone, name=" ".join(words))
            case "direction":
                bone = replace(bone, direction=file.vector(line, words, "direction"))
            case "length":
                bone = replace(bone, length=file.number(line, " ".join(words)))
            case "axis":
                axis = file.vector(line, words[:3], "axis")
                bone = replace(bone, axis=axis, order=_order(file, line, words[3:]))
            case "dof":
                bone = replace(bone, dof=_dof(file, line, words))
    if not bone.name:
        raise file.error(start, "this bone has no name", "name it")
    norm = float(np.linalg.norm(bone.direction))
    if bone.length < 0 or (bone.length > 0 and norm < 1e-6):
        problem = f"bone {quote(bone.name)} has no direction or a negative length"
        raise file.error(start, problem, "correct it")
    direction = bone.direction / norm if norm >= 1e-6 else np.array([0.0, 1.0, 0.0])
    return replace(bone, direction=direction)


def _order(file: TextFile, line: int, words: list[str]) -> str:
    order = "".join(words).lower()
    if order not in _ROTATION_ORDERS:
        raise file.error(line, f"{quote(order)} is not an order of axes", "state one, as XYZ")
    return order


def _dof(file: TextFile, line: int, words: list[str]) -> tuple[str, ...]:
    dof = tuple(word.lower() for word in words)
    for word in dof:
        if word not in _DOFS:
            problem = f"{quote(word)} is not a degree of freedom"
            raise file.error(line, problem, "use rx ry rz tx ty tz l")
        if dof.count(word) > 1:
            raise file.error(line, f"{quote(word)} is listed twice", "list it once")
    return dof
