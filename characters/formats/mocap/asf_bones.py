"""Root, bones and hierarchy of an .asf file."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from characters.errors import CharacterError
from characters.formats.mocap.asf_sections import Line, blocks
from characters.formats.mocap.text import number, refuse, shown, vector
from characters.skeleton import rotations
from characters.skeleton.pose import Array

_DOFS = ("tx", "ty", "tz", "rx", "ry", "rz", "l")
_ORDERS = ("xyz", "xzy", "yxz", "yzx", "zxy", "zyx")


@dataclass(frozen=True)
class Bone:
    """A bone, or the root."""

    name: str
    """Name, as in the .amc."""

    along: Array
    """Unit vector from its start to its end, in the file's axes, (3,)."""

    length: float
    """How long it is, in the file's unit; 0 for the root."""

    axis: Array
    """Angles of its own frame about the axes of `order`, in the file's unit, (3,)."""

    order: str
    """The axes in the order in which they are turned about, as "xyz"."""

    dof: tuple[str, ...]
    """What the numbers of a frame move: rx, ry, rz, tx, ty, tz, and l for its length."""

    position: Array
    """Where it starts when nothing moves, in the file's unit, (3,); 0 but for the root."""

    def frame(self, radians: float) -> Array:
        """Return the rotation from its own frame to the file's axes, (3, 3)."""
        q = rotations.from_euler(self.order[::-1], self.axis[::-1] * radians)
        return rotations.to_matrix(q)


def read_bones(path: Path, sections: dict[str, list[Line]]) -> tuple[list[Bone], list[int]]:
    """Return root and bones, parents first, and the number of each one's parent.

    Raises
    ------
    CharacterError
        If they contradict each other or are not one tree.
    """
    for name in ("root", "bonedata", "hierarchy"):
        if name not in sections:
            raise CharacterError(f"{path}: has no :{name}; is this a whole .asf?")
    root = _root(path, sections["root"])
    bones: dict[str, Bone] = {root.name: root}
    for start, lines in blocks(path, sections["bonedata"]):
        bone = _bone(path, start, lines)
        if bone.name in bones:
            raise refuse(path, start, f"a second bone {shown(bone.name)}", "rename one of them")
        bones[bone.name] = bone
    children = _children(path, sections["hierarchy"], bones)
    order, parents = [root.name], [-1]
    waiting = [(0, name) for name in reversed(children.get(root.name, []))]
    while waiting:
        parent, name = waiting.pop()
        waiting += [(len(order), child) for child in reversed(children.get(name, []))]
        order.append(name)
        parents.append(parent)
    hanging = set(order)
    lost = [name for name in bones if name not in hanging]
    if lost:
        raise CharacterError(
            f"{path}: bone {shown(lost[0])} does not hang on the root; "
            "name its parent in :hierarchy"
        )
    return [bones[name] for name in order], parents


def _children(path: Path, lines: list[Line], bones: dict[str, Bone]) -> dict[str, list[str]]:
    """Return every bone's children; every child has one parent."""
    children: dict[str, list[str]] = {}
    placed = {"root"}
    for _, inside in blocks(path, lines):
        for line, words in inside:
            for word in words:
                if word not in bones:
                    raise refuse(
                        path, line, f"no bone is called {shown(word)}", "add it to :bonedata"
                    )
            for child in words[1:]:
                if child in placed:
                    raise refuse(
                        path, line, f"{shown(child)} has a parent already", "keep one of them"
                    )
                placed.add(child)
            children.setdefault(words[0], []).extend(words[1:])
    return children


def _root(path: Path, lines: list[Line]) -> Bone:
    """Read the root: it starts at `position`, and turns about the axes of `orientation`."""
    position = axis = np.zeros(3)
    order = "xyz"
    dof: tuple[str, ...] = ("tx", "ty", "tz", "rx", "ry", "rz")
    for line, words in lines:
        key = words[0].lower()
        if key == "order":
            dof = _dof(path, line, words[1:])
        elif key == "axis":
            order = _order(path, line, words[1:])
        elif key == "position":
            position = vector(path, line, words[1:], "position")
        elif key == "orientation":
            axis = vector(path, line, words[1:], "orientation")
    return Bone("root", np.array([0.0, 1.0, 0.0]), 0.0, axis, order, dof, position)


def _bone(path: Path, start: int, lines: list[Line]) -> Bone:
    """Read one bone; its limits are not kept, nobody who was recorded broke them."""
    name, order = "", "xyz"
    dof: tuple[str, ...] = ()
    along, length, axis = np.zeros(3), 0.0, np.zeros(3)
    for line, words in lines:
        key = words[0].lower()
        if key == "name":
            name = " ".join(words[1:])
        elif key == "direction":
            along = vector(path, line, words[1:], "direction")
        elif key == "length":
            length = number(path, line, words[1] if len(words) == 2 else " ".join(words[1:]))
        elif key == "axis":
            axis = vector(path, line, words[1:4], "axis")
            order = _order(path, line, words[4:])
        elif key == "dof":
            dof = _dof(path, line, words[1:])
    if not name:
        raise refuse(path, start, "this bone has no name", "name it")
    far = float(np.linalg.norm(along))
    if length < 0 or (length > 0 and far < 1e-6):
        raise refuse(
            path, start, f"bone {shown(name)} has no direction or a negative length", "correct it"
        )
    along = along / far if far >= 1e-6 else np.array([0.0, 1.0, 0.0])
    return Bone(name, along, length, axis, order, dof, np.zeros(3))


def _order(path: Path, line: int, words: list[str]) -> str:
    order = "".join(words).lower()
    if order not in _ORDERS:
        raise refuse(path, line, f"{shown(order)} is no order of axes", "state one, as XYZ")
    return order


def _dof(path: Path, line: int, words: list[str]) -> tuple[str, ...]:
    dof = tuple(word.lower() for word in words)
    wrong = [word for word in dof if word not in _DOFS] or [
        word for word in dof if dof.count(word) > 1
    ]
    if wrong:
        raise refuse(
            path,
            line,
            f"{shown(wrong[0])} is no degree of freedom, or stands twice",
            "use rx ry rz tx ty tz l",
        )
    return dof
